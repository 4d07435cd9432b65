"""Planetary sets: modes in the plane and of helical sets, and shares of the load."""

import math
from dataclasses import replace

import numpy as np
import pytest
from planetary_scenes import BEARING_STIFFNESS, MESH_STIFFNESS, PRESSURE_ANGLE, planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.bearings import BearingStiffness
from dynamics.integrators import static_equilibrium
from dynamics.linearize import natural_modes

# Structure of the modes of helical planetary sets: T. Eritenel and R. G. Parker, Modal properties of three-
# dimensional helical planetary gears, Journal of Sound and Vibration 325 (2009), 397-420. With planets
# alike and equally spaced, central members alike in all directions and six freedoms per body, there are 12
# single rotational-axial modes (all planets do the same), 12 pairs of translational-tilting modes, and 6
# planet modes (central members are at rest) of N - 3 fold.


KINDS = ("x", "y", "z", "tilt_x", "tilt_y", "rotation")
CENTRAL = ("sun", "ring", "carrier")
HELD = BearingStiffness(1e8, 2e8, 3e5)
PIN = BearingStiffness(1e8, 1.5e8, 1e5)
HELIX = math.radians(22.0)
SMALL = 1e-6  # of a mode's largest displacement


def helical_modes(planets, helix=HELIX, off_center=4e-3):
    """Frequencies, and shapes (modes, bodies, 6) in meters, planets in axes that point away from the sun.

    Pins are `off_center` from mid-face: else forces at mid-face leave the rotation about an axis that
    points away from the sun to each planet alone, and N of these modes are alike.
    """
    gears = published_set(
        planets,
        sun_stiffness=HELD,
        ring_stiffness=HELD,
        carrier_stiffness=HELD,
        planet_stiffness=PIN,
        base_helix_angle=helix,
    )
    torsion = 1e9 * gears.base_radius[2] ** 2
    on = {"axial": "on", "tilt": "on", "lateral": "on"}
    scene = planetary_scene(gears, ring_support=torsion, effects=on)
    pins = tuple(replace(pin, position=pin.position + off_center) for pin in scene.planet_bearings)
    system = assemble(replace(scene, planet_bearings=pins))
    modes = natural_modes(system)
    bodies = [*CENTRAL, *(f"planet {i + 1}" for i in range(planets))]
    location = {name: index for index, name in enumerate(system.freedoms.name)}
    order = [location[f"{body}.{kind}"] for body in bodies for kind in KINDS]
    assert len(order) == len(location) == 6 * (planets + 3)
    shape = (modes.shape * system.arrays.scale)[:, order].reshape(-1, len(bodies), 6)
    for planet in range(planets):
        c, s = math.cos(2.0 * math.pi * planet / planets), math.sin(2.0 * math.pi * planet / planets)
        for at in ([0, 1], [3, 4]):
            shape[:, 3 + planet, at] = shape[:, 3 + planet, at] @ np.array([[c, -s], [s, c]])
    return modes.frequency, shape / np.max(np.abs(shape), axis=(1, 2))[:, None, None]


def kind_of(shape):
    """Name of a mode's kind, by what its central members and planets do."""
    central, planets = shape[:3], shape[3:]
    across, along = np.max(np.abs(central[:, [0, 1, 3, 4]])), np.max(np.abs(central[:, [2, 5]]))
    if across < SMALL and np.max(np.abs(planets - planets[0])) < SMALL:
        return "rotational-axial"
    assert along < SMALL
    return "planet" if across < SMALL else "translational-tilting"


@pytest.mark.parametrize("planets", [3, 4, 5])
def test_modes_fall_into_three_kinds_of_known_numbers(planets):
    frequency, shapes = helical_modes(planets)
    found = {"rotational-axial": [], "translational-tilting": [], "planet": []}
    for f, shape in zip(frequency, shapes, strict=True):
        found[kind_of(shape)].append(f)
    assert {kind: len(values) for kind, values in found.items()} == {
        "rotational-axial": 12,
        "translational-tilting": 24,
        "planet": 6 * (planets - 3),
    }
    for kind, fold in (("translational-tilting", 2), ("planet", planets - 3)):
        groups = np.reshape(found[kind], (-1, fold)) if fold else np.ones((1, 1))
        np.testing.assert_allclose(groups, np.repeat(groups[:, :1], groups.shape[1], axis=1), rtol=1e-8)
    single = np.array(found["rotational-axial"])
    assert np.min(np.diff(single)) > 1e-6 * single[-1]


def test_planets_move_by_weights_that_sum_to_zero_in_planet_modes():
    """Each planet's motion is a scalar times that of the first, w_i; sum w_i e^(i psi) = sum w_i = 0."""
    _, shapes = helical_modes(5)
    checked = 0
    for shape in shapes:
        if kind_of(shape) != "planet":
            continue
        planets = shape[3:]
        reference = planets[np.argmax(np.linalg.norm(planets, axis=1))]
        weight = planets @ reference / (reference @ reference)
        np.testing.assert_allclose(planets, weight[:, None] * reference, atol=1e-6)
        angle = 2.0j * np.pi * np.arange(5) / 5.0
        assert abs(np.sum(weight)) < 1e-6
        assert abs(np.sum(weight * np.exp(angle))) < 1e-6
        checked += 1
    assert checked == 12


def test_without_a_helix_the_plane_model_of_lin_and_parker_is_left():
    """Spur gears centered on their bearings: three freedoms per body move as in the plane."""
    frequency, shapes = helical_modes(3, 0.0, 0.0)
    plane = np.array([np.max(np.abs(shape[:, [2, 3, 4]])) < SMALL for shape in shapes])
    published = [1475.75, 1930.35, 2658.32, 7462.80, 11775.27]
    published += 2 * [743.16, 1102.42, 1896.02, 2276.38, 6986.30, 9647.91]
    assert np.count_nonzero(plane) == 18
    np.testing.assert_allclose(np.sort(frequency[plane])[1:], sorted(published), rtol=1e-4)


def test_the_helix_joins_plane_and_axial_motion():
    _, shapes = helical_modes(3)
    out_of, in_plane = (np.max(np.abs(shapes[:, :, at]), axis=(1, 2)) for at in ([2, 3, 4], [0, 1, 5]))
    assert np.count_nonzero((out_of > 0.05) & (in_plane > 0.05)) > 18


# Natural frequencies of the planetary set of Lin and Parker (1999), plane model, three freedoms per body.


RING_TORSION = 1e9  # N/m on the ring's base circle

# Hz; recomputed independently for the data of the 1999 example
ROTATIONAL = {
    3: [0.0, 1475.75, 1930.35, 2658.32, 7462.80, 11775.27],
    5: [0.0, 1567.40, 2006.08, 2614.80, 8065.39, 14253.09],
}
TRANSLATIONAL = {
    3: [743.16, 1102.42, 1896.02, 2276.38, 6986.30, 9647.91],
    5: [710.05, 1072.01, 1888.08, 2425.30, 7382.38, 11172.31],
}
PLANET = {3: [], 5: [1808.18, 5963.76, 6981.71]}


def modes_of(planets):
    gears = published_set(planets)
    system = assemble(planetary_scene(gears, ring_support=RING_TORSION * gears.base_radius[2] ** 2))
    return natural_modes(system)


@pytest.mark.parametrize("planets", [3, 5])
def test_natural_frequencies_are_the_published_ones(planets, record_figure):
    modes = modes_of(planets)
    expected = sorted([*ROTATIONAL[planets], *2 * TRANSLATIONAL[planets], *(planets - 3) * PLANET[planets]])
    assert modes.frequency.size == 3 * (planets + 3) == len(expected)
    assert modes.frequency[0] == 0.0
    error = np.abs(modes.frequency[1:] / np.array(expected[1:]) - 1.0)
    record_figure(
        f"natural frequencies, {planets} planets",
        float(np.max(error)),
        "at most 1e-4",
        "1",
        "Lin and Parker 1999",
    )
    assert np.max(error) < 1e-4


# Load sharing of planets with one displaced pin: static equilibrium against the closed form.


ERROR = 20e-6  # m, the pin of planet 1 against the carrier's motion
SUN_FORCE = 8000.0  # N, torque over base radius
FLOATING = 1.0  # N/m

# rigid carrier, ring held; recomputed independently to the digits shown
PUBLISHED = {
    (4, "floating"): [0.280661, 0.219339, 0.280661, 0.219339],
    (5, "fixed"): [0.298114, 0.175471, 0.175471, 0.175471, 0.175471],
}


def shares(planets, sun, error=ERROR):
    """Share of each planet in the load of the sun."""
    gears = published_set(
        planets,
        sun_stiffness=None if sun == "fixed" else FLOATING,
        ring_stiffness=None,
        carrier_stiffness=None,
        pin_errors=((0.0, -error), *[(0.0, 0.0)] * (planets - 1)),
    )
    solution = static_equilibrium(
        assemble(planetary_scene(gears, sun_torque=SUN_FORCE * gears.base_radius[0]))
    )
    assert solution.status.usable
    return solution.mesh_force[::2] / SUN_FORCE, solution.mesh_force[1::2] / SUN_FORCE


def closed_form(planets, sun):
    """L_i = 1/N + X (delta_i1 - w_i/N), w_i = 1 + 2 cos(psi_i) with a floating and 1 with a fixed sun."""
    cosine = math.cos(PRESSURE_ANGLE)
    stiffness = 1.0 / (2.0 / MESH_STIFFNESS + 4.0 * cosine**2 / BEARING_STIFFNESS)
    gain = 2.0 * cosine * stiffness * ERROR / SUN_FORCE
    assert gain == pytest.approx(0.122643, abs=5e-7)
    angle = 2.0 * np.pi * np.arange(planets) / planets
    weight = 1.0 + (2.0 * np.cos(angle) if sun == "floating" else 0.0)
    return 1.0 / planets + gain * ((np.arange(planets) == 0) - weight / planets)


@pytest.mark.parametrize("sun", ["fixed", "floating"])
@pytest.mark.parametrize("planets", [3, 4, 5])
def test_one_displaced_pin(planets, sun, record_figure):
    found, at_the_ring = shares(planets, sun)
    expected = closed_form(planets, sun)
    if (planets, sun) in PUBLISHED:
        np.testing.assert_allclose(expected, PUBLISHED[planets, sun], atol=1e-6)
    error = float(np.max(np.abs(found - expected)))
    record_figure(
        f"planet load sharing, {planets} planets, {sun} sun", error, "at most 1e-4", "1", "closed form"
    )
    assert error < 1e-4
    np.testing.assert_allclose(found, at_the_ring, rtol=1e-9)  # each planet passes on what it gets


def test_a_floating_sun_centers_itself_between_three_planets():
    found, _ = shares(3, "floating")
    np.testing.assert_allclose(found, 1.0 / 3.0, atol=1e-6)
    assert abs(shares(3, "fixed")[0][0] - 1.0 / 3.0) > 0.05
