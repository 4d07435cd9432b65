"""Sound power of a scene: closed form of a rigid sphere, scaling, superposition, shares, its file."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from hulls import box
from reduced_housings import PAIR, bare_housing
from sounding_housings import part_of_scene, rigid_housing
from sounding_scene import ON, SPEEDS, housing, oscillating, radiation, response, sound
from surface_motions import normal_displacement

from dynamics.acoustics import Air, ElementalRadiators, EquivalentRadiatedPower, monopoles_efficiency
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import forced_response
from dynamics.noise import housing_radiation, radiated_sound

AIR = Air()


def scaled(factor: float, bearings=slice(None)):
    force = np.array(response().bearing_force)
    force[bearings] *= factor
    return replace(response(), bearing_force=force)


def test_power_goes_with_the_square_of_the_force():
    twice = radiated_sound(scaled(2.0), housing(), None, radiation())
    np.testing.assert_allclose(twice.power, 4.0 * sound().power, rtol=1e-9)
    np.testing.assert_allclose(twice.orders.level - sound().orders.level, 20.0 * np.log10(2.0), atol=1e-8)
    np.testing.assert_allclose(twice.efficiency, sound().efficiency, rtol=1e-9)


@pytest.mark.parametrize("index", range(4))
def test_the_share_of_a_bearing_is_what_its_force_does(index):
    own = response().bearing.index(PAIR[index])
    others = [b for b in range(len(response().bearing)) if b != own]
    alone = radiated_sound(scaled(0.0, others), housing(), None, radiation())
    without = radiated_sound(scaled(0.0, own), housing(), None, radiation())
    scale = 1e-9 * sound().power.max()
    np.testing.assert_allclose(alone.power, sound().bearing_alone[index], rtol=1e-9, atol=scale)
    np.testing.assert_allclose(without.power, sound().without_bearing[index], rtol=1e-9, atol=scale)


def test_shares_add_up_to_the_power():
    np.testing.assert_allclose(sound().bearing_share.sum(axis=0), sound().power, rtol=1e-9)
    kept = len(housing().frequency)
    assert sound().mode_share.shape[0] == kept
    if kept == len(housing().stiffness):
        np.testing.assert_allclose(sound().mode_share.sum(axis=0), sound().power, rtol=1e-9)


@pytest.mark.parametrize("amplitude", [0.5e-6, 2e-6])
def test_flanks_of_twice_the_transmission_error_are_6_db_louder(amplitude):
    tables = [spring_table(3e8, factor * amplitude) for factor in (1.0, 2.0)]
    scenes = [gear_pair_scene(table, effects=ON) for table in tables]
    parts = (part_of_scene(housing()),)
    levels = []
    for scene in scenes:
        driven = forced_response(assemble(replace(scene, housings=parts)), SPEEDS, orders=1)
        levels.append(radiated_sound(driven, housing(), None, radiation()).orders.weighted_level)
    np.testing.assert_allclose(levels[1] - levels[0], 20.0 * np.log10(2.0), atol=1e-6)


def test_air_acts_from_one_motion_on_another_as_the_other_way_round():
    """Reciprocity of the radiation resistance, interpolated too."""
    matrix = radiation().matrix
    np.testing.assert_allclose(matrix, np.swapaxes(matrix, 1, 2), rtol=0.0, atol=1e-9 * np.abs(matrix).max())
    draw = np.random.default_rng(7)
    first, second = draw.normal(size=(2, len(housing().stiffness)))
    hertz = np.full(2, radiation().frequency[3] * 1.01)
    force = radiation().reaction(hertz, np.stack([first, second]) + 0j)
    assert second @ force[0] == pytest.approx(first @ force[1], rel=1e-9)


@pytest.mark.law
def test_a_rigid_sphere_on_springs_radiates_as_theory_says():
    body, driven, plane, ka = oscillating(5.0, 5.0 * (2.0 * np.pi * 250.0) ** 2)
    by_plane = housing_radiation(body, EquivalentRadiatedPower(), driven.frequency)
    found = radiated_sound(driven, body, None, by_plane)
    np.testing.assert_allclose(found.power, plane, rtol=0.03)  # panels of a sphere, 0.1 dB between knots
    np.testing.assert_allclose(found.efficiency, 1.0, rtol=0.03)
    monopoles = housing_radiation(body, ElementalRadiators(), driven.frequency)
    found = radiated_sound(driven, body, None, monopoles)
    expected = np.vectorize(lambda x: monopoles_efficiency(1, x))(ka)
    np.testing.assert_allclose(found.efficiency, expected, rtol=0.03)
    np.testing.assert_allclose(found.power, plane * expected, rtol=0.04)
    assert found.natural_frequency == pytest.approx([250.0] * 3)


@pytest.mark.law
def test_without_mass_to_speak_of_the_hull_follows_its_springs():
    stiffness = 1e6
    body, driven, _, _ = oscillating(1e-9, stiffness)
    found = radiated_sound(
        driven, body, None, housing_radiation(body, EquivalentRadiatedPower(), driven.frequency)
    )
    velocity = 3.0 * 2.0 * np.pi * driven.frequency / stiffness
    area = normal_displacement(body.surface)[1].sum()
    np.testing.assert_allclose(found.power, AIR.impedance * area * velocity**2 / 6.0, rtol=0.03)


def test_what_does_not_belong_together_is_refused():
    body = oscillating(1.0, 1e6)[0]
    with pytest.raises(InputError, match="radiation"):
        radiated_sound(response(), body, ("input.left",), radiation())
    with pytest.raises(InputError, match="housing with a surface"):
        housing_radiation(bare_housing(), ElementalRadiators(), [100.0])
    high = replace(response(), frequency=10.0 * response().frequency)
    with pytest.raises(InputError, match="frequency"):
        radiated_sound(high, housing(), None, radiation())


def rounds_up(hull) -> bool:
    """Whether the limit of a hull, in Hz and back, is above itself by rounding."""
    limit = hull.highest_wavenumber * AIR.sound_speed / (2.0 * np.pi)
    return 2.0 * np.pi * limit / AIR.sound_speed > hull.highest_wavenumber


def test_a_mesh_that_resolves_no_more_gives_way_to_the_plane_whatever_is_rounded():
    cubes = (box((length, length, length), (2, 2, 2)) for length in np.linspace(0.2, 0.3, 100))
    coarse = rigid_housing(10.0, 1e6, 0.02, next(hull for hull in cubes if rounds_up(hull)))
    found = housing_radiation(coarse, ElementalRadiators(), [100.0, 5000.0], AIR)
    limit = found.metadata.resolved_frequency
    assert 100.0 < limit < 5000.0
    assert limit == pytest.approx(found.frequency[np.searchsorted(found.frequency, limit)], rel=1e-9)
