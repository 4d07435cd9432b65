"""Laws of linear vibration on a housing with mass: reciprocity, superposition, scaling with load and speed.

Scenes are pairs without gyroscopic moments in a housing of random full matrices.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, square_wave_table

from dynamics import Housing, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.linearize import HarmonicResponse, harmonic_response
from dynamics.loads import AppliedForce, Orders

NAMES = ("input.left", "input.right", "output.left", "output.right")
ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on", "gyroscopic": "off"}
SPEEDS = np.array([60.0, 150.0, 300.0])
LEVEL = 1e-9


def definite(seed, scale):
    """A matrix over five motions of four seats, and tilts by a lever of 0.1 m."""
    unit = np.tile([1.0, 1.0, 1.0, 0.1, 0.1], len(NAMES))
    factor = np.random.default_rng(seed).normal(size=(unit.size, unit.size))
    matrix = scale * np.outer(unit, unit) * (factor @ factor.T / unit.size + 0.5 * np.eye(unit.size))
    return tuple(map(tuple, matrix.tolist()))


def scene_on(table, forces=(), torque=100.0):
    housing = Housing("case", NAMES, definite(1, 3e8), definite(2, 3e3), definite(3, 4.0))
    pair = gear_pair_scene(table, torque=torque, speed=TimeLaw.constant(150.0), effects=ON)
    return replace(pair, housings=(housing,), forces=tuple(forces))


def push(shaft, force, order=20.0, size=1.0):
    """A force on the middle of a shaft, a wave of an order of the driving one."""
    course = Orders("input", (order,), (size,), (0.0,))
    return AppliedForce(f"{shaft} {force}", shaft, 0.1, force, course=course)


def response(scene, orders=1) -> HarmonicResponse:
    return harmonic_response(assemble(scene), SPEEDS, orders)


@cache
def pushed(*directions: tuple[str, tuple[float, float, float]]) -> HarmonicResponse:
    """Vibration by forces alone: the mesh is a spring without ripple."""
    return response(scene_on(spring_table(4e8), [push(*one) for one in directions]))


def moved(found: HarmonicResponse, freedom: str) -> np.ndarray:
    return found.displacement[found.freedom.index(freedom)]


def assert_same(found, expected) -> None:
    found, expected = np.asarray(found), np.asarray(expected)
    assert np.max(np.abs(expected)) > 0.0
    assert np.max(np.abs(found - expected)) < LEVEL * np.max(np.abs(expected))


ALONG = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@pytest.mark.parametrize(
    ("first", "second"),
    [(("input", "x"), ("output", "y")), (("input", "y"), ("output", "z")), (("input", "z"), ("input", "x"))],
)
def test_what_a_force_here_moves_there_a_force_there_moves_here(first, second):
    there = moved(pushed((first[0], ALONG[first[1]])), ".".join(second))
    here = moved(pushed((second[0], ALONG[second[1]])), ".".join(first))
    assert_same(there, here)
    assert np.all(np.abs(there) > 0.0)


def test_vibrations_by_two_forces_add_up():
    a, b = ("input", (300.0, 0.0, 0.0)), ("output", (0.0, -200.0, 50.0))
    for quantity in ("displacement", "bearing_force", "mesh_force"):
        parts = [getattr(pushed(*chosen), quantity) for chosen in ((a,), (b,))]
        assert_same(getattr(pushed(a, b), quantity), parts[0] + parts[1])


def test_vibrations_grow_with_the_force_and_with_the_error_of_the_mesh():
    one, seven = (pushed(("input", (size, 0.0, 0.0))).bearing_force for size in (1.0, 7.0))
    assert_same(seven, 7.0 * one)
    small, large = (response(scene_on(spring_table(4e8, ripple))).bearing_force for ripple in (1e-8, 5e-8))
    assert_same(large, 5.0 * small)


def test_the_load_presses_the_mesh_and_moves_no_vibration_of_a_spring():
    """The ripple of its error is the same under any load; the mean forces follow the load."""
    light, heavy = (response(scene_on(spring_table(4e8, 1e-8), torque=load)) for load in (50.0, 400.0))
    assert_same(heavy.mean_force, 8.0 * light.mean_force)
    for quantity in ("displacement", "bearing_force", "mesh_force"):
        assert_same(getattr(heavy, quantity), getattr(light, quantity))


def test_an_order_at_a_speed_is_its_double_at_half_the_speed():
    """Motion per exciting error depends on the frequency alone."""
    speeds = np.array([75.0, 150.0, 300.0])
    found = harmonic_response(assemble(scene_on(square_wave_table())), speeds, 4)
    transfer = found.displacement / found.static_transmission_error[0]
    first, second, fourth = (list(found.order).index(order) for order in (1.0, 2.0, 4.0))
    size = np.max(np.abs(transfer[:, 2, first]))
    for other in (transfer[:, 1, second], transfer[:, 0, fourth]):
        assert np.max(np.abs(other - transfer[:, 2, first])) < LEVEL * size
    slower = np.max(np.abs(transfer[:, 1, first] - transfer[:, 2, first]))
    assert slower > 0.1 * size
