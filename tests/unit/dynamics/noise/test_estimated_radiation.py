"""What monopoles and equivalent radiated power both allow: spheres in closed form, a housing by its modes."""

import numpy as np
import pytest
from sounding_scene import AIR, housing, radiation, response

from dynamics.acoustics import ElementalRadiators, monopoles_efficiency, outer_hull, sphere_efficiency
from dynamics.noise import HousingRadiation, estimated_radiation, panel_sound, radiated_sound
from dynamics.noise.estimated_radiation import allowed_levels


def sphere_levels(order: int, ka: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return levels of a sphere over its equivalent radiated power, exact and by monopoles, dB."""
    exact, monopoles = ([of(order, float(x)) for x in ka] for of in (sphere_efficiency, monopoles_efficiency))
    return 10.0 * np.log10(exact), 10.0 * np.log10(np.maximum(monopoles, 1e-300))


def allowed(order: int, ka: np.ndarray):
    monopoles = sphere_levels(order, ka)[1][:, None]
    return (part[:, 0] for part in allowed_levels(monopoles, 0.0 * monopoles, ka, np.ones(len(ka), bool)))


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("ka", [0.2, 0.5, 1.0, 1.83, 2.5])
def test_a_pulsating_and_an_oscillating_sphere_lie_where_both_models_allow(order, ka):
    at = np.array([ka])
    low, high, by_velocity = allowed(order, at)
    assert low[0] < sphere_levels(order, at)[0][0] < high[0]
    assert not by_velocity[0]


@pytest.mark.parametrize("ka", [3.0, np.pi, 3.3])
def test_a_pulsating_sphere_at_its_interior_resonance_is_that_of_its_velocity(ka):
    """Monopoles are 16 dB off at ka 3 and silent at pi."""
    at = np.array([ka])
    exact, monopoles = sphere_levels(0, at)
    low, high, by_velocity = allowed(0, at)
    assert by_velocity[0] and monopoles[0] < exact[0] - 12.0
    assert low[0] < exact[0] < high[0] < low[0] + 6.0


@pytest.mark.parametrize("order", [0, 1, 2])
def test_nine_of_ten_spheres_lie_where_both_models_allow(order):
    ka = np.linspace(0.1, 8.0, 400)
    low, high, _ = allowed(order, ka)
    exact = sphere_levels(order, ka)[0]
    assert np.mean((exact >= low) & (exact <= high)) > 0.9


def test_monopoles_alone_count_where_a_small_body_hardly_radiates():
    """Equivalent radiated power is 100 dB too loud there: that is no interior resonance."""
    low, high, by_velocity = allowed_levels(
        np.array([[-100.0]]), np.array([[0.0]]), np.array([0.5]), np.array([True])
    )
    assert (low[0, 0], high[0, 0], by_velocity[0, 0]) == (-102.0, -93.0, False)


@pytest.fixture(scope="module")
def estimate():
    return estimated_radiation(housing(), radiation(), AIR)


def alone(made: HousingRadiation) -> np.ndarray:
    shape = housing().modes[1]
    return 10.0 * np.log10(np.einsum("mk,fmn,nk->fk", shape, made.matrix, shape).real)


def test_every_mode_alone_lies_in_its_band_and_takes_power(estimate):
    own, monopoles = alone(estimate), alone(radiation())
    low, high = estimate.mode_error
    assert np.all(low < 0.0) and np.all(high > 0.0)
    shape = housing().modes[1]
    plane = 10.0 * np.log10(AIR.impedance * np.einsum("mk,mn,nk->k", shape, radiation().surface, shape))
    ka = 2.0 * np.pi / AIR.sound_speed * estimate.frequency * outer_hull(housing()).hull.equivalent_radius
    resolved = estimate.frequency <= estimate.metadata.resolved_frequency
    lowest, highest, _ = allowed_levels(monopoles, plane[None], ka, resolved)
    np.testing.assert_allclose(own - high, lowest, atol=1e-6)
    np.testing.assert_allclose(own - low, highest, atol=1e-6)
    eigenvalues = np.linalg.eigvalsh(estimate.matrix)
    assert np.all(eigenvalues >= -1e-12 * eigenvalues.max(axis=1, keepdims=True))


def test_panels_add_up_to_the_power_of_the_estimate(estimate):
    sound = radiated_sound(response(), housing(), None, estimate)
    assert sound.metadata["radiation"]["housing"]["model_name"] == "estimate"
    for at in ((0, 0), (2, 1)):
        panels = panel_sound(response(), housing(), None, estimate, at, ElementalRadiators(), AIR)
        assert panels.power.sum() == pytest.approx(sound.power[at], rel=1e-9)
        low, high = estimate.error_band(float(sound.frequency[at]), sound.mode_alone[:, at[0], at[1]])
        assert -9.0 < low < 0.0 < high < 9.0


def test_modes_at_interior_resonances_are_named(estimate):
    natural = housing().frequency
    assert estimate.replaced(natural).size == 0
    object.__setattr__(estimate, "by_velocity", np.ones_like(estimate.by_velocity))
    inside = (natural >= estimate.frequency[0]) & (natural <= estimate.metadata.resolved_frequency)
    np.testing.assert_array_equal(estimate.replaced(natural), natural[inside])
