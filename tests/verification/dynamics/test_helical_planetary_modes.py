"""Structure of the modes of helical planetary sets: T. Eritenel and R. G. Parker, Modal properties of
three-dimensional helical planetary gears, Journal of Sound and Vibration 325 (2009), 397-420.

With planets alike and equally spaced, central members alike in all directions and six freedoms per body,
there are 12 single rotational-axial modes (all planets do the same), 12 pairs of translational-tilting modes,
and 6 planet modes (central members are at rest) of N - 3 fold.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from planetary_scenes import planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.bearings import BearingStiffness
from dynamics.linearize import natural_modes

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
