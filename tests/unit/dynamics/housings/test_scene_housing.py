"""A reduced housing as a part of a scene: the same motion of its seats, and seats along z alone."""

from dataclasses import replace

import numpy as np
import pytest
from lattice_meshes import tube

from dynamics.errors import InputError
from dynamics.housings import (
    Bore,
    Foot,
    Material,
    MaterialDamping,
    MeshedHousing,
    Mount,
    Plane,
    ReducedMatrices,
    SeatBore,
    housing_of_matrices,
    receptance,
    reduced_housing,
    scene_housing,
)
from dynamics.mechanism.bodies import modal_housing

SEATS = tuple(
    SeatBore(name, Bore((0.0, 0.0, z), (0.0, 0.0, toward), 0.08, 0.05))
    for name, z, toward in (("upper", 0.075, 1.0), ("lower", 0.025, -1.0))
)
MOUNT = Mount(
    tuple(map(tuple, np.diag([2e8, 2e8, 3e8, 1e6, 1e6, 1e6]).tolist())),
    tuple(map(tuple, np.diag([2e3, 2e3, 3e3, 10.0, 10.0, 10.0]).tolist())),
)
TUBE = MeshedHousing(
    tube(0.12, 0.08, 0.1, (8, 1, 4)),
    Material(210e9, 0.3, 7850.0),
    SEATS,
    (Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), MOUNT),),
    modes=6,
    damping=MaterialDamping(0.02),
)


@pytest.fixture(scope="module")
def reduced():
    return reduced_housing(TUBE)


def test_its_seats_move_as_those_of_the_reduced_housing(reduced):
    """Static and vibrating, damped by its mount; the lower bore points down: its y and z are turned over."""
    housing = scene_housing(reduced, "case")
    modal = modal_housing(housing)
    assert housing.bushings == ("upper", "lower")
    np.testing.assert_allclose(housing.seat_positions, [[0.0, 0.0, 0.075], [0.0, 0.0, 0.025]], atol=1e-12)
    shape = modal.shape.reshape(10, -1)
    over = np.diag([1.0] * 5 + [1.0, -1.0, -1.0, 1.0, -1.0])
    hertz = [0.0, 0.5 * modal.frequency[0], 1.3 * modal.frequency[0]]
    for frequency, expected in zip(hertz, receptance(reduced, hertz), strict=True):
        omega = 2.0 * np.pi * frequency
        dynamic = np.diag(modal.stiffness - omega**2) + 1j * omega * modal.damping
        found = shape @ np.linalg.solve(dynamic, shape.T)
        wanted = over @ expected[:10] @ over
        unit = np.sqrt(np.outer(np.abs(np.diag(wanted)), np.abs(np.diag(wanted))))
        np.testing.assert_allclose(found / unit, wanted / unit, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(modal.frequency[:6], reduced.frequency, rtol=1e-6)


def test_modal_damping_couples_no_modes():
    held = replace(TUBE, feet=(Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))),))
    modal = modal_housing(scene_housing(reduced_housing(held), "case"))
    np.testing.assert_array_equal(modal.damping, np.diag(np.diag(modal.damping)))
    ratio = np.diag(modal.damping) / (2.0 * np.sqrt(modal.stiffness))
    np.testing.assert_allclose(ratio[:6], 0.01, rtol=1e-6)


def test_a_stiffness_alone_is_a_housing_without_mass(reduced):
    seats = tuple(replace(seat, axes=np.eye(3)) for seat in reduced.seats)
    matrices = ReducedMatrices(1e8 * np.eye(10))
    housing = scene_housing(housing_of_matrices(matrices, seats), "case", ("a", "b"))
    assert housing.mass is None and housing.bushings == ("a", "b")
    np.testing.assert_array_equal(housing.stiffness, 1e8 * np.eye(10))


def test_seats_that_fit_no_scene_are_named(reduced):
    lying = replace(reduced.seats[0], axes=np.eye(3)[:, [2, 0, 1]])
    with pytest.raises(InputError, match=r"off by 1\.57 rad") as caught:
        scene_housing(replace(reduced, seats=(lying, reduced.seats[1])), "case")
    assert caught.value.field == "seats.upper"
    seats = (replace(reduced.seats[0], motions=("x", "y", "z")), reduced.seats[1])
    with pytest.raises(InputError) as caught:
        scene_housing(replace(reduced, seats=seats), "case")
    assert caught.value.field == "seats"
    loose = reduced_housing(replace(TUBE, feet=()))
    with pytest.raises(InputError, match="Hold the housing at its feet") as caught:
        scene_housing(loose, "case")
    assert caught.value.field == "stiffness"
