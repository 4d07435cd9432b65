"""The condensed peer against CalculiX on the same meshes, where it is installed: penalty against none."""

from dataclasses import replace

import pytest
from calculix import find_calculix, solve_position

from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear
from fe_contact.geometry import ParallelAxes
from verification.full_contact import Resolution, solve_full_contact

CALCULIX = find_calculix()
RELIEF = FlankModification(tip_relief=20e-6, tip_relief_length=1.5e-3)
PINION = Gear(24, 3e-3, 20e-3, bore_diameter=30e-3, modification=RELIEF)
WHEEL = Gear(36, 3e-3, 20e-3, bore_diameter=45e-3)
SPUR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
CASES: dict[str, tuple[ParallelAxes, float, float]] = {  # pair, torque, position by the driven gear
    "tip edge": (GearPair(SPUR, SPUR, 80e-3), 400.0, 0.2),
    "relieved": (GearPair(PINION, WHEEL, 90e-3), 150.0, 0.3),
    "unlike": (GearPair(replace(PINION, modification=FlankModification()), WHEEL, 90e-3), 150.0, -0.1),
    "internal": (
        InternalGearPair(
            Gear(24, 2e-3, 20e-3, bore_diameter=24e-3),
            RingGear(72, 2e-3, 20e-3, rim_diameter=164e-3, addendum_coefficient=0.85),
        ),
        150.0,
        0.033,
    ),
}
MESH = Resolution(3.0)
SOURCE = "CalculiX, surface-to-surface penalty contact, the same mesh"


@pytest.mark.nightly  # tests/unit/verification/full_contact/test_full_contact.py holds one pair against it
@pytest.mark.skipif(CALCULIX is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("name", CASES)
def test_two_contact_solvers_agree_on_one_mesh(name, record_figure):
    assert CALCULIX is not None
    pair, torque, position = CASES[name]
    point = solve_position(CALCULIX, pair, float(pair.normal_force(torque)), position, 300.0, MESH)
    assert point.status.usable, point.reason
    (own,) = solve_full_contact(pair, [torque], [point.position], MESH).points[0]
    assert own.status.usable, own.reason
    apart = 100.0 * abs(own.transmission_error / point.transmission_error - 1.0)
    record_figure(f"condensed full contact beside CalculiX, {name}", apart, "at most 0.1 %", "%", SOURCE)
    assert apart < 0.1
    assert own.torque_ratio == pytest.approx(point.torque_ratio, rel=2e-3)
