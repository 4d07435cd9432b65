"""CalculiX on the mesh of one position: equilibrium, and the condensed peer."""

from dataclasses import replace

import pytest
from calculix import find_calculix, solve_position
from spur_gears import GEAR

from fe_contact import FlankModification, GearPair
from verification.full_contact import Resolution, solve_full_contact

CALCULIX = find_calculix()
TORQUE = 400.0
CROWNED = replace(GEAR, modification=FlankModification(profile_crowning=20e-6))
COARSE = Resolution(1.5)

pytestmark = pytest.mark.skipif(CALCULIX is None, reason="CalculiX (ccx) is not installed")


@pytest.mark.parametrize("gear", [pytest.param(GEAR, marks=pytest.mark.nightly), CROWNED])
def test_equilibrium_and_the_condensed_peer(gear):
    assert CALCULIX is not None
    pair = GearPair(gear, gear, center_distance=80e-3)
    point = solve_position(CALCULIX, pair, float(pair.normal_force(TORQUE)), 0.0, 300.0, COARSE)
    assert point.status.usable, point.reason
    assert abs(point.residual) < 1e-6  # moment of the contact forces is the torque that was requested
    assert point.torque_ratio == pytest.approx(1.0, abs=1e-3)  # on the line of action, equal base radii
    assert point.position * pair.base_pitch == pytest.approx(point.transmission_error, rel=1e-9, abs=0.0)
    own = solve_full_contact(pair, [TORQUE], [point.position], COARSE).transmission_error[0, 0]
    assert point.transmission_error == pytest.approx(own, rel=2e-3, abs=0.0)


def test_a_position_past_its_limit_is_said():
    pair = GearPair(GEAR, GEAR, center_distance=80e-3)
    assert CALCULIX is not None
    point = solve_position(CALCULIX, pair, float(pair.normal_force(TORQUE)), 0.0, 1.0, Resolution(6.0))
    assert not point.status.usable
    assert "within 1 CPU s" in point.reason
    assert set(point.to_json()) == {"status", "iterations", "reason"}
