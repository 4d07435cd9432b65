"""Motion of a housing under its bearings: statics, resonance in closed form, the motion within a scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from reduced_housings import PAIR, PER_SEAT, random_housing

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.housings import receptance, scene_housing
from dynamics.linearize import forced_response
from dynamics.mechanism.bodies import modal_housing
from dynamics.vibration import housing_motion, seat_forces

ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
SPEEDS = np.array([60.0, 150.0, 420.0])


def scene_in(housing):
    scene = gear_pair_scene(square_wave_table(), effects=ON)
    part = replace(scene_housing(housing, "case"), seat_positions=None)
    return replace(scene, housings=(part,))


def test_forces_on_the_seats_move_the_housing_as_the_scene_does():
    housing = random_housing()
    system = assemble(scene_in(housing))
    response = forced_response(system, SPEEDS, orders=4)
    force = seat_forces(response, housing)
    motion = housing_motion(housing, response.frequency, force)
    modal = modal_housing(system.scene.housings[0])
    amplitude = response.displacement[[response.freedom.index(f"case.{kind}") for kind in modal.kinds]]
    for index, seat in enumerate(housing.seats):
        own = np.kron(np.eye(2), seat.axes.T)[:PER_SEAT, :PER_SEAT] @ modal.seat(seat.name)
        expected = np.einsum("cm,msh->shc", own, amplitude)
        found = motion[..., PER_SEAT * index : PER_SEAT * (index + 1)]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_a_steady_force_deflects_by_the_compliance():
    housing = random_housing()
    force = np.random.default_rng(3).normal(size=housing.motions)
    whole = np.concatenate([force, np.zeros(len(housing.stiffness) - housing.motions)])
    found = housing_motion(housing, np.zeros(()), force + 0j)
    np.testing.assert_allclose(found, np.linalg.solve(housing.stiffness, whole), rtol=1e-9)


def test_motions_add_up_and_are_those_of_the_receptance():
    housing = random_housing()
    hertz = np.array([300.0, 900.0, 2500.0])
    draw = np.random.default_rng(4)
    first, second = draw.normal(size=(2, 3, housing.motions)) + 1j * draw.normal(size=(2, 3, housing.motions))
    both = housing_motion(housing, hertz, first + 2.0 * second)
    parts = housing_motion(housing, hertz, first) + 2.0 * housing_motion(housing, hertz, second)
    np.testing.assert_allclose(both, parts, rtol=1e-9)
    by_receptance = np.einsum("nrs,ns->nr", receptance(housing, hertz), first)
    found = housing_motion(housing, hertz, first)
    np.testing.assert_allclose(found, by_receptance, rtol=1e-7)


def test_what_is_asked_without_sense_is_refused():
    housing = random_housing()
    with pytest.raises(InputError, match="force"):
        housing_motion(housing, np.array([100.0]), np.zeros((2, housing.motions), dtype=complex))
    massless = replace(housing, mass=np.zeros_like(housing.mass))
    with pytest.raises(InputError, match="housing with mass"):
        housing_motion(massless, np.array([100.0]), np.zeros((1, housing.motions), dtype=complex))
    response = forced_response(assemble(scene_in(housing)), SPEEDS[:1], orders=2)
    with pytest.raises(InputError, match=r"bearings\[1\]"):
        seat_forces(response, housing, ("input.left", "none", *PAIR[2:]))
    with pytest.raises(InputError, match="one per seat"):
        seat_forces(response, housing, PAIR[:3])
