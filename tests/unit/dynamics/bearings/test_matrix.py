"""Bearings by a matrix, and runs on them."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene
from rotors_on_bearings import KINDS, ON, PRELOAD, SEATS, pair_of, rotor

from dynamics import Bushing, Integration, simulate
from dynamics.assembly.assemble import assemble
from dynamics.bearings import RollingBearing
from dynamics.bearings.matrix import check_matrix, congruent
from dynamics.errors import InputError
from dynamics.integrators import integrate, static_equilibrium

# Matrices of joints: what is positive semidefinite to rounding passes, what is not is refused.


EPS = float(np.finfo(float).eps)
STIFF = 1e9


def rows(matrix):
    return tuple(tuple(map(float, row)) for row in matrix)


def bearing(**matrices):
    return Bushing("b", "s", 0.0, **{name: rows(matrix) for name, matrix in matrices.items()})


def damper_along_x(turned):
    """A damper along x in axes turned twice, there and back: what is left across it is rounding."""
    c, s = np.cos(turned), np.sin(turned)
    turn = np.array([[c, -s], [s, c]])
    return turn.T @ (turn @ np.diag([2.0e3, 0.0]) @ turn.T) @ turn


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("location", [1, 2, 3, 4])
def test_what_arithmetic_leaves_across_a_damper_is_no_negative_damping(location, sign):
    """Of a damper of 2 kN s/m along x products of turns leave some eps across: -2.7e-15 was refused."""
    damping = np.diag([2.0e3, 0.0, 0.0, 0.0, 0.0])
    damping[location, location] = sign * 6.0 * EPS * 2.0e3
    assert bearing(damping=damping).seat_damping[0, 0] == 2.0e3


@pytest.mark.parametrize("seed", range(20))
def test_axes_turned_and_turned_back_leave_a_bearing(seed):
    turned = np.random.default_rng(seed).uniform(0.0, 6.3)
    damping = np.zeros((5, 5))
    damping[:2, :2] = damper_along_x(turned)
    damping = 0.5 * (damping + damping.T)
    turned_back = bearing(damping=damping, stiffness=STIFF / 2.0e3 * damping)
    np.testing.assert_array_equal(turned_back.seat_damping, damping)


@pytest.mark.parametrize("seed", range(20))
def test_tangents_brought_to_a_bearing_are_semidefinite_however_they_round(seed):
    """Rank one in two rows, seen along five directions, each entry off by an eps of the largest."""
    random = np.random.default_rng(seed)
    along = random.normal(size=2)
    tangent = 2.0e3 * np.outer(along, along)
    off = EPS * np.max(tangent) * random.choice([-1.0, 1.0], size=(2, 2))
    motion = random.normal(size=(2, 5)) * [1.0, 1e-8, 1.0, 0.1, 1e-8]
    brought = congruent(tangent + off, motion)
    exact = motion.T @ tangent @ motion
    diagonal = np.sqrt(np.diag(brought))
    assert np.all(np.diag(brought) >= 0.0)
    assert np.linalg.eigvalsh(brought / np.outer(diagonal, diagonal))[0] > -20.0 * EPS
    assert np.max(np.abs(brought - exact)) <= 40.0 * EPS * np.max(np.abs(exact))
    bearing(damping=brought)


@pytest.mark.parametrize("stiff", [1.0, 1e6, 1e12])
@pytest.mark.parametrize("soft", [1e-3, 1e-1])
def test_a_soft_direction_that_pushes_away_is_refused_beside_stiff_ones(stiff, soft):
    stiffness = np.diag([stiff, -soft * stiff, stiff, 0.0, 0.0])
    with pytest.raises(InputError, match="negative eigenvalue"):
        bearing(stiffness=stiffness)


def test_a_negative_tilt_stiffness_is_refused_beside_stiff_springs():
    with pytest.raises(InputError, match="negative eigenvalue"):
        bearing(stiffness=np.diag([STIFF, STIFF, STIFF, -1.0e3, 1.0e3]))


def test_more_across_than_two_springs_allow_is_refused():
    stiffness = np.diag([STIFF, 1.0e5, 0.0, 0.0, 0.0])
    stiffness[0, 1] = stiffness[1, 0] = 1.01 * np.sqrt(STIFF * 1.0e5)
    with pytest.raises(InputError, match="negative eigenvalue"):
        bearing(stiffness=stiffness)
    stiffness[0, 1] = stiffness[1, 0] = 0.99 * np.sqrt(STIFF * 1.0e5)
    bearing(stiffness=stiffness)


def test_a_free_housing_written_with_seven_digits_passes():
    """Three seats on one free rigid beam: its rigid motions have eigenvalues that the digits leave."""
    chain = np.array([[1.0, -2.0, 1.0]]) * np.sqrt(STIFF / 3.0)
    written = np.array([[float(f"{value:.6e}") for value in row] for row in chain.T @ chain])
    written[0, 0] *= 1.0 - 8e-7
    check_matrix("stiffness", written, (3,), 1e-6)
    with pytest.raises(InputError, match="negative eigenvalue"):
        check_matrix("stiffness", written, (3,))


def test_a_row_about_the_axis_may_hold_rounding_and_no_more():
    stiffness = np.diag([STIFF, STIFF, 0.0, 0.0, 0.0, 8.0 * EPS * STIFF])
    bearing(stiffness=stiffness)
    stiffness[5, 5] = 1e-6 * STIFF
    with pytest.raises(InputError, match="rotation about the axis"):
        bearing(stiffness=stiffness)


@pytest.mark.parametrize("ragged", [((1.0,), (), (), (), ()), ((1.0,) * 5,) * 4 + ((1.0,) * 4,)])
def test_rows_of_different_lengths_are_refused(ragged):
    with pytest.raises(InputError, match="rows of different lengths"):
        Bushing("b", "s", 0.0, damping=ragged)


# Runs of rotors on rolling bearings: paths, energy balance, loads at rest.


@pytest.mark.parametrize("kind", ["deep groove", "cylindrical"])
def test_a_run_says_what_its_bearings_carry_at_rest(kind):
    """Stribeck: under no clearance the heaviest of n elements carries about 4.37 or 4.08 W/n."""
    straight = {"profile": "straight"} if kind == "cylindrical" else {}
    row, weight = replace(KINDS[kind], clearance=0.0, **straight), 40.0 * 9.81
    scene = rotor((row, row), gravity=(0.0, -9.81, 0.0), duration=0.001)
    found = simulate(scene).receipt["rolling_bearings"]
    stribeck = {"deep groove": 4.37, "cylindrical": 4.08}[kind]
    for name in ("seat 0", "seat 1"):
        at = found[name]
        np.testing.assert_allclose(at["force"][:3], [0.0, -weight / 2.0, 0.0], atol=1e-5 * weight)
        assert at["element_load"] == pytest.approx(stribeck * weight / 2.0 / row.count, rel=0.02)
        assert at["displacement"][1] < 0.0
        if kind == "deep groove":
            inner = row.contacts()[0].peak_pressure(at["element_load"])
            assert at["peak_pressure"] == pytest.approx(inner, rel=1e-12)


def thrown(method, kind, tolerance=1e-11):
    """A rotor at rest thrown upwards and tilting: its path, and the run."""
    preload = 0.0 if kind in SEATS else PRELOAD
    scene = rotor(pair_of(KINDS[kind]), preload, gravity=(0.0, -9.81, 3.0), duration=0.01, kind=kind)
    system = assemble(scene)
    start = static_equilibrium(system)
    velocity = np.zeros(start.displacement.size)
    for freedom, rate in (("y", 0.02), ("z", 0.005), ("tilt_x", 0.05)):
        velocity[system.freedoms.name.index(f"rotor.{freedom}")] = rate
    run = integrate(system, start, Integration(method=method, tolerance=tolerance), velocity=velocity)
    assert run.status.usable
    return np.array([q for q, name in zip(run.q.T, system.freedoms.name, strict=True) if "rotor." in name])


@pytest.mark.parametrize("kind", ["angular", "tapered", "floating", "cross-located"])
def test_both_integrators_take_the_same_path(kind):
    explicit, implicit = (thrown(method, kind) for method in ("explicit", "implicit"))
    largest = np.max(np.abs(explicit[:3]))
    for path, other, scale in zip(explicit, implicit, (1.0, 1.0, 1.0, 0.1, 0.1, 0.1), strict=True):
        np.testing.assert_allclose(scale * other, scale * path, atol=1e-4 * largest)
    assert np.max(np.abs(explicit[1])) > 1e-6


@pytest.mark.parametrize("kind", ["angular", "floating", "cross-located"])
def test_a_run_closes_its_energy_balance(kind):
    scene = gear_pair_scene(effects=ON, duration=0.02)
    seats = SEATS.get(kind, ("both", "both"))
    bearings = tuple(
        RollingBearing(
            bushing.name,
            bushing.shaft,
            row,
            bushing.position,
            np.sign(row.contact_angle) * 200.0,
            locating=seat,
        )
        for bushing, row, seat in zip(scene.bushings, 2 * pair_of(KINDS[kind]), 2 * seats, strict=True)
    )
    scene = replace(scene, bushings=(), rolling_bearings=bearings, integration=Integration(tolerance=1e-10))
    result = simulate(scene)
    assert result.status.usable
    assert result.energy.relative < 1e-3
    assert result.energy.bushings > 0.0
