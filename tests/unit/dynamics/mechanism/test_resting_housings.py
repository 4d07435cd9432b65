"""Bearings that are not linear in a housing without mass: their laws at rest, in motion their tangents."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_bushings, with_gear

from dynamics import Housing, RollingContact, simulate
from dynamics.assembly.assemble import assemble
from dynamics.deflection import LoadCase, deflect
from dynamics.errors import InputError
from dynamics.linearize import natural_modes

NAMES = ("input.left", "input.right", "output.left", "output.right")
ON = {"lateral": "on", "axial": "on", "tilt": "on"}
HOOKE = 3e8


def rows(matrix):
    return tuple(tuple(float(value) for value in row) for row in np.asarray(matrix))


def definite(size, seed, scale):
    factor = np.random.default_rng(seed).normal(size=(size, size))
    return rows(scale * (factor @ factor.T / size + 0.5 * np.eye(size)))


def scene(laws=(), mass=None, stiffness=None, **changes):
    """A pair off the middle of its shafts; bearings have three rows each in the housing."""
    pair = gear_pair_scene(spring_table(4e8), effects=ON)
    pair = with_gear(with_gear(pair, 0, position=0.06), 1, position=0.06)
    pair = with_bushings(pair, radial_stiffness=0.0 if laws else HOOKE)
    housing = Housing("case", NAMES, stiffness or definite(12, 1, 3e8), mass=mass)
    return replace(pair, rolling_contacts=laws, housings=(housing,), **changes)


def contacts(exponent, clearance, stiffness=HOOKE):
    return tuple(RollingContact(name, stiffness, exponent, clearance) for name in NAMES)


CLEARANCE = contacts(1.5, 10e-6, 1e11)


def case_of(given):
    return deflect(given, (LoadCase("load"),), 4).cases[0]


def test_linear_laws_rest_as_linear_bearings_do_in_the_condensed_housing():
    lawful, linear = case_of(scene(contacts(1.0, 0.0))), case_of(scene())
    scale = max(abs(part.misalignment) for part in linear.meshes)
    for one, other in zip(lawful.meshes, linear.meshes, strict=True):
        assert one.misalignment == pytest.approx(other.misalignment, abs=1e-8 * scale)
    for one, other in zip(lawful.bearings, linear.bearings, strict=True):
        np.testing.assert_allclose(one.force, other.force, rtol=0.0, atol=1e-6 * np.abs(other.force).max())
        np.testing.assert_allclose(one.seat, other.seat, rtol=0.0, atol=1e-7 * np.abs(other.seat).max())


def test_the_rest_is_that_of_a_housing_of_any_mass():
    none, heavy = case_of(scene(CLEARANCE)), case_of(scene(CLEARANCE, mass=definite(12, 5, 40.0)))
    assert none.status == heavy.status == "converged"
    assert none.meshes[0].misalignment == pytest.approx(heavy.meshes[0].misalignment, rel=1e-8)
    for one, other in zip(none.bearings, heavy.bearings, strict=True):
        np.testing.assert_allclose(one.clearance, other.clearance, rtol=0.0, atol=1e-12)


def test_the_seats_yield_what_their_forces_and_the_stiffness_say():
    case = case_of(given := scene(CLEARANCE))
    by_name = {load.name: load for load in case.bearings}
    force = np.concatenate([np.asarray(by_name[name].force)[:3] for name in NAMES])
    seat = np.concatenate([np.asarray(by_name[name].seat)[:3] for name in NAMES])
    pressed = np.array(given.housings[0].stiffness) @ seat
    np.testing.assert_allclose(pressed, force, rtol=0.0, atol=1e-6 * np.abs(force).max())


def test_in_motion_bearings_have_their_tangents_at_the_load():
    """As in a housing of a mass that does not matter, below its modes."""
    light = scene(CLEARANCE, mass=definite(12, 5, 1e-4))
    found = natural_modes(assemble(scene(CLEARANCE))).frequency
    low = found[found < 3000.0]
    assert low.size > 4
    np.testing.assert_allclose(
        natural_modes(assemble(light)).frequency[: low.size], low, rtol=2e-4, atol=1e-2
    )


@pytest.mark.parametrize("choice", ["auto", "on", "off"])
def test_the_ledger_says_that_there_are_tangents_and_why(choice):
    given = scene(CLEARANCE, effects=ON | {"bearing_clearance": choice})
    entries = assemble(given).ledger.of("bearing_clearance")
    assert {(entry.choice, entry.on, entry.possible) for entry in entries} == {(choice, False, False)}
    assert all("has no mass" in entry.reason and entry.influence > 0.0 for entry in entries)
    massive = assemble(scene(CLEARANCE, mass=definite(12, 5, 40.0))).ledger.of("bearing_clearance")
    assert all(entry.on for entry in massive)


def test_a_run_on_the_tangents_closes_its_balance():
    result = simulate(scene(CLEARANCE, duration=0.01))
    assert result.status == 0 and result.energy.relative < 1e-4


def test_a_housing_that_nothing_holds_in_a_direction_is_refused():
    loose = rows(np.diag([3e8] * 11 + [0.0]))
    with pytest.raises(InputError) as caught:
        scene(CLEARANCE, stiffness=loose)
    assert caught.value.field == "housings[0].stiffness"
