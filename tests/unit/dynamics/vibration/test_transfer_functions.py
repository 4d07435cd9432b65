"""Transfer functions: a beam in closed form, reciprocity, superposition, a rigid body on a mount, units."""

import math
from dataclasses import replace

import numpy as np
import pytest
from reduced_housings import random_housing
from tubular_housings import BORE, GROUND, LENGTH, OUTER, RATIO, SEAT, cantilever, two_seats

from dynamics.acoustics import Air, EquivalentRadiatedPower, outer_hull, sound_power
from dynamics.errors import InputError
from dynamics.housings import Mount
from dynamics.vibration import (
    MotionQuantity,
    housing_motion,
    mean_square_mobility,
    surface_weight,
    transfer_functions,
    vibration_level,
)


def on_mount(stiffness, loss=0.0):
    """The tube's foot on a mount with springs and dampers along the axes."""
    matrices = np.diag([stiffness] * 3 + [1e5] * 3), np.diag([loss] * 3 + [0.0] * 3)
    return replace(GROUND, mount=Mount(*(tuple(map(tuple, matrix.tolist())) for matrix in matrices)))


ROOTS = (1.8751040687, 4.6940911330)  # cosh cos = -1


def beam_shape(root: float, z: float) -> float:
    """Mode of a cantilever with a mean square of 1; 2 at its end."""
    sigma = (math.sinh(root) - math.sin(root)) / (math.cosh(root) + math.cos(root))
    angle = root * z / LENGTH
    return math.cosh(angle) - math.cos(angle) - sigma * (math.sinh(angle) - math.sin(angle))


@pytest.mark.parametrize("root", ROOTS)
def test_the_mobility_of_a_beam_at_resonance_is_that_of_its_mode(root):
    """phi(response) phi(excitation) / (2 zeta m omega), at the frequency of Euler and Bernoulli."""
    housing = cantilever()
    area = math.pi * (OUTER**2 - BORE**2) / 4.0
    inertia = math.pi * (OUTER**4 - BORE**4) / 64.0
    omega = root**2 * math.sqrt(210e9 * inertia / (7850.0 * area * LENGTH**4))
    natural = housing.frequency[np.argmin(np.abs(housing.frequency - omega / (2.0 * math.pi)))]
    assert natural == pytest.approx(omega / (2.0 * math.pi), rel=0.03)  # shear and rotary inertia lower it
    ((mobility,),) = transfer_functions(housing, np.array([natural]), housing.points[0].motion[:1])[:, :, 0]
    shapes = beam_shape(root, LENGTH) * beam_shape(root, LENGTH - SEAT / 2.0)
    expected = shapes / (2.0 * RATIO * 7850.0 * area * LENGTH * 2.0 * math.pi * natural)
    assert mobility == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize("coupled", [False, True])
def test_response_and_excitation_can_be_exchanged(coupled):
    housing = random_housing(coupled=coupled)
    hertz = np.array([200.0, 1400.0, 5000.0])
    first, second = (np.random.default_rng(seed).normal(size=(4, len(housing.mass))) for seed in (1, 2))
    there = transfer_functions(housing, hertz, first, second)
    back = transfer_functions(housing, hertz, second, first)
    np.testing.assert_allclose(there, np.swapaxes(back, 1, 2), rtol=0.0, atol=1e-9 * np.abs(there).max())


@pytest.mark.parametrize("quantity", MotionQuantity)
def test_transfer_functions_add_up_to_the_motion_under_all_forces(quantity):
    housing = random_housing(coupled=True)
    hertz = np.linspace(100.0, 4000.0, 150)  # more than a block of matrices
    rows = np.concatenate([point.motion for point in housing.points])
    draw = np.random.default_rng(3)
    force = draw.normal(size=(150, housing.motions)) + 1j * draw.normal(size=(150, housing.motions))
    found = np.einsum("nqs,ns->nq", transfer_functions(housing, hertz, rows, None, quantity), force)
    motion = housing_motion(housing, hertz, force) @ rows.T
    expected = motion * (2j * np.pi * hertz[:, None]) ** {"d": 0, "v": 1, "a": 2}[quantity[0]]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-14])
@pytest.mark.parametrize("coupled", [False, True])
def test_a_housing_without_damping_is_refused_in_its_resonance_and_not_beside_it(coupled, off):
    damped = random_housing(coupled=coupled)
    housing = replace(damped, damping=0.0 * damped.damping)
    hertz = np.array([0.9, 1.0 + off, 1.1]) * housing.frequency[0]
    row = housing.points[0].motion[:1]
    with pytest.raises(InputError, match=r"frequency = .* off the natural frequency .* Hz") as caught:
        transfer_functions(housing, hertz, row)
    assert f"{housing.frequency[0]:.7g} Hz" in str(caught.value) and "damping" in str(caught.value)
    assert np.all(np.isfinite(transfer_functions(housing, hertz[[0, 2]], row)))


def test_a_stiff_housing_on_a_mount_is_a_mass_on_a_spring():
    stiffness, loss = 1e6, 60.0
    housing = two_seats(on_mount(stiffness, loss))
    mass = housing.body.mass
    resonance = math.sqrt(stiffness / mass) / (2.0 * math.pi)
    hertz = np.array([0.5, 1.0, 2.0, 4.0]) * resonance
    up = housing.points[0].motion[2:]
    found = transfer_functions(housing, hertz, up, None, MotionQuantity.DISPLACEMENT)[:, 0, 2]
    omega = 2.0 * np.pi * hertz
    expected = 1.0 / (stiffness - mass * omega**2 + 1j * omega * loss)
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_only_the_ends_of_a_stiff_tube_move_along_their_normal_in_a_motion_along_it():
    housing = two_seats(on_mount(1e4))
    hertz = np.array([200.0])  # above the mount's 7 Hz, below the first elastic mode
    found = mean_square_mobility(housing, hertz, surface_weight(housing))[0, 2]
    ends, sides = 2.0 * math.pi / 4.0 * (0.12**2 - 0.08**2), math.pi * 0.1 * (0.12 + 0.08)
    square = 1.0 / (2.0 * np.pi * hertz[0] * housing.body.mass) ** 2
    assert found == pytest.approx(square * ends / (ends + sides), rel=0.01)


def test_the_mean_square_gives_the_equivalent_radiated_power():
    housing, air = two_seats(), Air()
    hertz = np.array([3000.0])
    mobility = transfer_functions(housing, hertz, np.eye(len(housing.mass)))[0]
    hull, shapes = (outer := outer_hull(housing)).hull, outer.shapes
    power = [
        sound_power(EquivalentRadiatedPower(), hull, 3000.0, shapes @ column, air) for column in mobility.T
    ]
    found = mean_square_mobility(housing, hertz, surface_weight(housing))[0]
    np.testing.assert_allclose(0.5 * air.impedance * hull.area * found, power, rtol=1e-9)


def test_levels_are_those_of_the_standard():
    assert vibration_level(1e-3) == pytest.approx(120.0)  # 1 mm/s
    assert vibration_level(1e-3, MotionQuantity.ACCELERATION) == pytest.approx(60.0)
    assert vibration_level(1e-6, MotionQuantity.DISPLACEMENT) == pytest.approx(120.0)
    assert vibration_level(0.0) == -200.0
    with pytest.raises(InputError, match="rms"):
        vibration_level(-1.0)


def test_negative_frequencies_are_refused():
    with pytest.raises(InputError, match=r"frequency\[0\]"):
        transfer_functions(random_housing(), np.array([-1.0]), np.ones((1, 23)))
