"""Elements that pass one by one: angle of the cage, motion under a load, energy, decision, refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics import Coupling, Inertia, Integration, Shaft, TimeLaw, simulate, steady_states
from dynamics.assembly.assemble import assemble
from dynamics.bearings import BallBearing, RollerBearing, RollingBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.passing_elements import element_passing
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.motion.observation import local_state

ON = {"lateral": "on", "axial": "on", "tilt": "on", "element_passing": "on"}
BALLS = BallBearing(count=7, diameter=11.5e-3, pitch_diameter=43.5e-3, clearance=1e-5)
ANGULAR = BallBearing(8, 11.5e-3, 43.5e-3, contact_angle=0.6)
ROLLERS = RollerBearing(14, 9e-3, 13.6e-3, 53.5e-3, clearance=1e-5, laminae=10)
SPEED, MASS = 10.0, 40.0


def rotor(rows, preload=0.0, effects=ON, **changes):
    """A heavy shaft on two rolling bearings, turned through a soft coupling by a gear pair's driver."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(SPEED), effects=effects)
    shaft = Shaft("rotor", 0.2, (0.0, 0.0, 0.4), Inertia(MASS, 0.05, 0.1))
    bearings = tuple(
        RollingBearing(f"seat {z:g}", "rotor", row, z, math.copysign(preload, row.contact_angle))
        for row, z in zip(rows, (0.02, 0.18), strict=True)
    )
    fields = {"rolling_bearings": bearings, "gravity": (0.0, -9.81, 0.0)} | changes
    coupling = Coupling("joint", "input", "rotor", 100.0)
    return replace(scene, shafts=(*scene.shafts, shaft), couplings=(coupling,), **fields)


@pytest.mark.parametrize("row", [BALLS, ROLLERS], ids=["balls", "rollers"])
def test_the_rotor_rests_where_the_bearing_does_at_the_cages_angle(row):
    """The inner ring turns: the next element is in place after 1/(n cage_ratio) of a revolution."""
    system = assemble(rotor((row, row)))
    at = [system.freedoms.name.index(f"rotor.{kind}") for kind in "xy"]
    passing = 2.0 * math.pi / SPEED / (row.count * row.cage_ratio)
    alone, moved = LoadedBearing(row), []
    for share in (0.0, 0.3, 0.75, 1.0):
        found = static_equilibrium(system, share * passing)
        assert found.status.usable
        angle = share * 2.0 * math.pi / row.count
        expected = alone.displacement((0.0, -0.5 * 9.81 * MASS, 0.0, 0.0, 0.0), angle)
        np.testing.assert_allclose(found.displacement[at], expected[:2], atol=1e-6 * abs(expected[1]))
        moved.append(found.displacement[at])
    np.testing.assert_allclose(moved[3], moved[0], atol=1e-9 * abs(moved[0][1]) + 1e-12)
    size = element_passing(row, (0.0, -0.5 * 9.81 * MASS, 0.0, 0.0, 0.0)).peak_to_peak
    assert np.ptp(moved, axis=0)[1] > 0.3 * size[1] > 1e-9


def test_the_cage_of_a_bearing_turns_with_its_contact_angle():
    for row in (BALLS, ANGULAR):
        system = assemble(rotor((row, replace(row, contact_angle=-row.contact_angle))))
        n = system.arrays.mass.shape[0]
        position = local_state(system.arrays, 0.25, np.zeros(n), np.zeros(n)).position[-2:]
        share = 11.5e-3 / 43.5e-3 * math.cos(row.contact_angle)
        expected = 0.25 * SPEED / (2.0 * math.pi) * (1.0 - share) / 2.0
        np.testing.assert_allclose(position, expected, rtol=1e-9)


def test_a_run_closes_its_energy_balance_though_the_cages_work():
    scene = rotor((BALLS, BALLS), duration=0.1)
    fast = replace(scene.drives[0], speed=TimeLaw.constant(100.0))
    result = simulate(replace(scene, drives=(fast,), integration=Integration(tolerance=1e-11)))
    assert result.status.usable
    assert result.energy.relative < 1e-3
    assert abs(result.energy.position) > 10.0 * abs(result.energy.residual)


def test_the_tolerance_decides_by_the_size():
    scene = rotor((BALLS, BALLS), effects={k: v for k, v in ON.items() if k != "element_passing"})
    found = {}
    for tolerance in (None, 0.5, 1e-5):
        system = assemble(replace(scene, tolerance=tolerance))
        entries = {entry.part: entry for entry in system.ledger.of("element_passing")}
        found[tolerance] = entries["rotor"]
        assert not entries["input"].possible
    assert [found[tolerance].on for tolerance in (None, 0.5, 1e-5)] == [False, False, True]
    assert found[None].influence == found[1e-5].influence > 0.0


def test_periodic_states_are_refused_by_the_name_of_the_effect():
    with pytest.raises(InputError) as caught:
        steady_states(assemble(rotor((BALLS, BALLS))), [5.0])
    assert caught.value.field == "effects.element_passing"
