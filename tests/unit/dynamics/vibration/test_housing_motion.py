"""Motion of a housing under its bearings: statics, resonance in closed form, the motion within a scene."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.housing_modes import (
    ModalDamping,
    Ring,
    SeatFrame,
    housing_of_matrices,
    receptance,
    scene_housing,
)
from dynamics.housing_modes.reduced_matrices import ReducedMatrices
from dynamics.housing_modes.seats import MOTIONS
from dynamics.linearize import forced_response
from dynamics.mechanism.modal_housing import modal_housing
from dynamics.vibration import housing_motion, seat_forces

PER_SEAT = 5
ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
SPEEDS = np.array([60.0, 150.0, 420.0])


def reduced(names, modal=3, seed=1):
    """A held housing of random matrices; seats turned about z, so that their axes are not the scene's."""
    lever = np.concatenate([np.tile([1.0, 1.0, 1.0, 0.1, 0.1], len(names)), np.ones(modal)])
    matrices = []
    for number, scale in enumerate((3e8, 4.0)):
        factor = np.random.default_rng(seed + number).normal(size=(lever.size, lever.size))
        full = scale * (factor @ factor.T / lever.size + 0.5 * np.eye(lever.size))
        matrices.append(np.outer(lever, lever) * full)
    seats = tuple(_seat(name, 0.3 * index) for index, name in enumerate(names))
    return housing_of_matrices(ReducedMatrices(*matrices), seats, ModalDamping((0.02,)))


def _seat(name, angle):
    c, s = math.cos(angle), math.sin(angle)
    axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return SeatFrame(name, np.zeros(3), axes, Ring.RIGID, MOTIONS[:PER_SEAT])


def scene_in(housing):
    scene = gear_pair_scene(square_wave_table(), effects=ON)
    part = replace(scene_housing(housing, "case"), seat_positions=None)
    return replace(scene, housings=(part,))


NAMES = ("input.left", "input.right", "output.left", "output.right")


def test_forces_on_the_seats_move_the_housing_as_the_scene_does():
    housing = reduced(NAMES)
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
    housing = reduced(NAMES)
    force = np.random.default_rng(3).normal(size=housing.motions)
    whole = np.concatenate([force, np.zeros(len(housing.stiffness) - housing.motions)])
    found = housing_motion(housing, np.zeros(()), force + 0j)
    np.testing.assert_allclose(found, np.linalg.solve(housing.stiffness, whole), rtol=1e-9)


def test_motions_add_up_and_are_those_of_the_receptance():
    housing = reduced(NAMES)
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
    housing = reduced(NAMES)
    with pytest.raises(InputError, match="force"):
        housing_motion(housing, np.array([100.0]), np.zeros((2, housing.motions), dtype=complex))
    massless = replace(housing, mass=np.zeros_like(housing.mass))
    with pytest.raises(InputError, match="housing with mass"):
        housing_motion(massless, np.array([100.0]), np.zeros((1, housing.motions), dtype=complex))
    response = forced_response(assemble(scene_in(housing)), SPEEDS[:1], orders=2)
    with pytest.raises(InputError, match=r"bearings\[1\]"):
        seat_forces(response, housing, ("input.left", "none", *NAMES[2:]))
    with pytest.raises(InputError, match="one per seat"):
        seat_forces(response, housing, NAMES[:3])
