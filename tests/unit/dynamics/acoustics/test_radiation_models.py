"""Radiation models: closed forms of sphere and piston, and the laws that hold for every one of them."""

import numpy as np
import pytest
from hulls import box, sphere
from scipy.special import j1

from dynamics.acoustics import (
    Air,
    ElementalRadiators,
    EquivalentRadiatedPower,
    Hull,
    errors_db,
    mean_square_velocity,
    modal_resistance,
    monopoles_efficiency,
    panel_power,
    radiation_efficiency,
    resistance,
    sound_power,
    sphere_efficiency,
)
from dynamics.acoustics.air import mutual_resistance
from dynamics.errors import InputError

AIR = Air()
MODELS = [EquivalentRadiatedPower(), ElementalRadiators(), ElementalRadiators(baffled=True)]
SPHERE = sphere(12)


def frequency(ka: float, radius: float = 1.0) -> float:
    return ka * AIR.sound_speed / (2.0 * np.pi * radius)


def random_shapes(hull: Hull, count: int = 5) -> np.ndarray:
    parts = np.random.default_rng(1).normal(size=(2, len(hull.triangles), count))
    return parts[0] + 1j * parts[1]


def test_the_efficiencies_of_the_sphere_are_the_known_fractions():
    for ka in (0.1, 0.7, 1.83, 5.0):
        assert sphere_efficiency(0, ka) == pytest.approx(ka**2 / (1 + ka**2), rel=1e-12)
        assert sphere_efficiency(1, ka) == pytest.approx(ka**4 / (4 + ka**4), rel=1e-12)
    assert errors_db(1.83)["equivalent_radiated_power"][0] == pytest.approx(1.1347, abs=1e-4)
    assert errors_db(0.01)["monopoles"][1] == pytest.approx(10.0 * np.log10(4.0 / 9.0), abs=1e-3)


def test_the_sphere_exceeds_its_equivalent_radiated_power_as_stated():
    ka = np.linspace(0.05, 30.0, 2000)
    maximum = [10.0 * np.log10(max(sphere_efficiency(order, x) for x in ka)) for order in range(6)]
    assert maximum[0] < 0.0
    assert maximum[1] < 0.0
    assert 0.25 < maximum[2] < maximum[5] < 1.5


@pytest.mark.parametrize("ka", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("order", [0, 1])
def test_models_miss_the_sphere_by_their_stated_errors(ka, order):
    velocity = np.ones(len(SPHERE.areas)) if order == 0 else SPHERE.normals[:, 2]
    exact = sphere_efficiency(order, ka)
    for model in MODELS[:2]:
        sigma = radiation_efficiency(model, SPHERE, frequency(ka), velocity, AIR)
        assert 10.0 * np.log10(sigma / exact) == pytest.approx(
            errors_db(ka)[model.model_name][order], abs=0.06
        )


def test_monopoles_on_a_sphere_converge_with_the_square_of_the_edges():
    misses = []
    for divisions in (6, 12):
        hull = sphere(divisions)
        sigma = radiation_efficiency(MODELS[1], hull, frequency(1.5), np.ones(len(hull.areas)), AIR)
        misses.append(abs(sigma / monopoles_efficiency(0, 1.5) - 1.0))
    assert misses[0] / misses[1] == pytest.approx(4.0, rel=0.1)
    assert misses[1] < 0.01


def disc(rings: int) -> Hull:
    """Plane disc of radius 1 with equal areas of its triangles but for a few percent."""
    nodes, triangles = [np.zeros((1, 3))], []
    for ring in range(1, rings + 1):
        angle = 2.0 * np.pi * np.arange(6 * ring) / (6 * ring)
        nodes.append(ring / rings * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1))
        inner, outer = 1 + 3 * (ring - 1) * (ring - 2), 1 + 3 * ring * (ring - 1)
        for sector in range(6):
            for part in range(ring):
                at = outer + sector * ring + part
                after = outer + (sector * ring + part + 1) % (6 * ring)
                within = 0 if ring == 1 else inner + (sector * (ring - 1) + part) % (6 * (ring - 1))
                triangles.append((at, after, within))
                if part:
                    before = inner + sector * (ring - 1) + part - 1
                    triangles.append((at, within, before))
    return Hull(np.concatenate(nodes), np.array(triangles))


@pytest.mark.law
@pytest.mark.parametrize("ka", [0.5, 1.0, 2.0, 4.0])
def test_a_baffled_piston_radiates_as_rayleigh_says(ka):
    piston = disc(24)
    assert piston.area == pytest.approx(np.pi, rel=2e-3)
    sigma = radiation_efficiency(MODELS[2], piston, frequency(ka), np.ones(len(piston.areas)), AIR)
    assert sigma == pytest.approx(1.0 - j1(2.0 * ka) / ka, rel=0.01)


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.model_name)
def test_resistance_is_reciprocal_and_takes_energy_from_every_motion(model):
    hull = box((0.4, 0.3, 0.2), (6, 5, 4))
    shapes = random_shapes(hull)
    matrix = resistance(model, hull, 300.0, shapes, AIR)
    np.testing.assert_allclose(matrix, matrix.conj().T, atol=1e-12 * np.abs(matrix).max())
    assert np.linalg.eigvalsh(matrix).min() >= -1e-12 * np.abs(matrix).max()
    real = resistance(model, hull, 300.0, shapes.real, AIR)
    np.testing.assert_allclose(real, real.T, rtol=1e-12)


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.model_name)
def test_shapes_superpose_and_power_goes_with_the_square(model):
    hull = box((0.4, 0.3, 0.2), (6, 5, 4))
    shapes, factors = random_shapes(hull), np.array([1.0, 2j, -0.5, 0.1 + 1j, 3.0])
    matrix = resistance(model, hull, 300.0, shapes, AIR)
    whole = sound_power(model, hull, 300.0, shapes @ factors, AIR)
    assert whole == pytest.approx(0.5 * np.real(factors.conj() @ matrix @ factors), rel=1e-9)
    assert sound_power(model, hull, 300.0, 3.0 * shapes @ factors, AIR) == pytest.approx(
        9.0 * whole, rel=1e-9
    )


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.model_name)
def test_where_the_hull_is_does_not_matter(model):
    hull = box((0.4, 0.3, 0.2), (6, 5, 4))
    turn, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    moved = Hull(hull.nodes @ turn.T + np.array([3.0, -2.0, 7.0]), hull.triangles)
    shapes = random_shapes(hull)
    np.testing.assert_allclose(
        resistance(model, hull, 300.0, shapes, AIR), resistance(model, moved, 300.0, shapes, AIR), rtol=1e-9
    )


@pytest.mark.parametrize("hull", [box((0.4, 0.3, 0.2), (6, 5, 4)), sphere(6, 0.2)], ids=["pairs", "waves"])
@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.model_name)
def test_a_panel_gives_its_velocity_times_the_pressure_of_all(model, hull):
    """Against the matrix of all panels by themselves: every panel is a shape."""
    velocity = random_shapes(hull, 1)[:, 0] * np.exp(1j * np.arange(len(hull.areas)))
    matrix = resistance(model, hull, 400.0, np.eye(len(hull.areas)), AIR)
    expected = 0.5 * np.real(velocity.conj() * (matrix @ velocity))
    panels = panel_power(model, hull, 400.0, velocity, AIR)
    np.testing.assert_allclose(panels, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    assert panels.sum() == pytest.approx(sound_power(model, hull, 400.0, velocity, AIR), rel=1e-9)


def test_a_panel_against_the_motion_of_its_neighbors_takes_power():
    hull = sphere(6, 0.1)
    velocity = np.ones(len(hull.areas))
    velocity[0] = -1.0
    panels = panel_power(ElementalRadiators(), hull, 200.0, velocity, AIR)
    assert np.flatnonzero(panels < 0.0).tolist() == [0]


def test_a_velocity_that_is_not_of_the_panels_is_refused():
    with pytest.raises(InputError, match="shapes"):
        panel_power(MODELS[0], sphere(2), 200.0, np.ones(3), AIR)


def test_panels_add_up_to_the_equivalent_radiated_power():
    hull = box((0.4, 0.3, 0.2), (6, 5, 4))
    velocity = random_shapes(hull, 1)[:, 0]
    whole = sound_power(MODELS[0], hull, 500.0, velocity, AIR)
    panels = panel_power(MODELS[0], hull, 500.0, velocity, AIR)
    np.testing.assert_allclose(panels, 0.5 * AIR.impedance * hull.areas * np.abs(velocity) ** 2, rtol=1e-12)
    assert whole == pytest.approx(AIR.impedance * hull.area * mean_square_velocity(hull, velocity), rel=1e-12)


def test_interpolated_modes_radiate_what_the_model_says():
    """A hundred frequencies from nine: within 0.05 dB."""
    hull = box((0.4, 0.3, 0.2), (6, 5, 4))
    shapes = np.stack([np.ones(len(hull.areas)), *hull.normals.T, hull.centers[:, 0] * hull.normals[:, 1]], 1)
    made = modal_resistance(MODELS[1], hull, np.linspace(100.0, 500.0, 9), shapes, AIR)
    velocity = np.random.default_rng(4).normal(size=(100, 5)) + 1j
    at = np.linspace(100.0, 500.0, 100)
    direct = [
        0.5 * np.real(v.conj() @ resistance(MODELS[1], hull, f, shapes, AIR) @ v)
        for f, v in zip(at, velocity, strict=True)
    ]
    miss = np.abs(10.0 * np.log10(made.power(at, velocity) / direct))
    assert miss.max() < 0.05
    assert miss[0] < 1e-9
    assert miss[-1] < 1e-9


def test_interpolated_power_is_never_negative():
    hull = box((0.4, 0.3, 0.2), (4, 4, 4))
    made = modal_resistance(MODELS[1], hull, np.array([50.0, 200.0, 400.0]), random_shapes(hull, 6), AIR)
    velocity = random_shapes(hull, 6)
    assert made.power(np.linspace(50.0, 400.0, len(velocity)), velocity).min() > 0.0


def test_what_cannot_be_used_is_refused():
    hull = box((0.4, 0.3, 0.2), (3, 3, 3))
    shapes = random_shapes(hull, 2)
    with pytest.raises(InputError, match=r"frequency.*at most"):
        resistance(MODELS[1], hull, 5000.0, shapes, AIR)
    with pytest.raises(InputError, match="shapes"):
        resistance(MODELS[0], hull, 100.0, shapes[:-1], AIR)
    made = modal_resistance(MODELS[0], hull, np.array([50.0, 90.0]), shapes, AIR)
    with pytest.raises(InputError, match=r"frequency.*from 50 Hz"):
        made.power(np.array([49.0]), np.ones((1, 2)))
    with pytest.raises(InputError, match="at least two"):
        modal_resistance(MODELS[0], hull, np.array([50.0]), shapes, AIR)
    with pytest.raises(InputError, match="area"):
        Hull(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    with pytest.raises(InputError, match="nodes from 0 to 2"):
        Hull(np.eye(3), np.array([[0, 1, 3]]))
    with pytest.raises(InputError, match="closed hull"):
        Hull(hull.nodes, hull.triangles[1:]).require_closed()
    with pytest.raises(InputError, match="volume"):
        Hull(hull.nodes, hull.triangles[:, ::-1]).require_closed()


@pytest.mark.law
@pytest.mark.parametrize("ka", [0.01, 1.0, 6.0])
def test_plane_waves_give_the_sum_over_pairs(ka):
    """Free monopoles by directions against sin(kr)/(kr) of every pair."""
    points, wavenumber = SPHERE.centers, ka
    shapes = random_shapes(SPHERE)
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    by_pairs = shapes.conj().T @ np.sinc(wavenumber * distance / np.pi) @ shapes
    found = mutual_resistance(points, shapes, wavenumber)
    np.testing.assert_allclose(found, by_pairs, rtol=0.0, atol=1e-8 * np.abs(by_pairs).max())
