"""Tip edges that touch off the line of action, against full contact."""

import math

import numpy as np
import pytest

from benchmarks.full_contact_cases import full_contact_cases
from benchmarks.full_contact_coverage import reference
from fe_contact import Gear, GearPair, analyze
from verification.full_contact import solve_full_contact

SOURCE = "full finite-element contact by condensation, plane strain, 0.02 % off at most points"
MODULE, PRESSURE_ANGLE, SHIFTS = 3e-3, math.radians(25.0), (0.51, -0.26)
TORQUES = (20.0, 100.0, 400.0)
AT_EDGES = (-0.08, 0.0)
"""A strip that begins to reach the edge; the edge of another pair that touches, the flanks wide open."""


@pytest.mark.law
@pytest.mark.parametrize("name", ["24/72, ring", "31/90, ring"])
def test_no_position_of_a_ring_gear_is_off(name, record_figure):
    """0.20 and 0.41 % at worst where strips at edges had the length of one load, and teeth only turned."""
    (case,) = (one for one in full_contact_cases() if one.name == name)
    position, exact, _ = reference(name)
    table = analyze(case.pair, normal_forces=case.forces, model="plane_strain", receipt="minimal")
    ours = np.array([table.curve(force=force, at=position).ste for force in table.force]).T
    worst = 100.0 * float(np.nanmax(np.abs(ours / exact - 1.0)))
    record_figure(f"STE at tip edges, {name}", worst, "at most 0.18 %", "%", SOURCE)
    assert worst < 0.18


def pointed_pair() -> GearPair:
    """14/84 teeth, the pinion 0.2 modules wide at its tip."""
    teeth = (14, 84)

    def involute(angle):
        return math.tan(angle) - angle

    target = involute(PRESSURE_ANGLE) + 2.0 * math.tan(PRESSURE_ANGLE) * sum(SHIFTS) / sum(teeth)
    working = PRESSURE_ANGLE
    for _ in range(20):
        working -= (involute(working) - target) / math.tan(working) ** 2
    apart = 0.5 * MODULE * sum(teeth) * math.cos(PRESSURE_ANGLE) / math.cos(working)
    bores = 0.9 * (teeth[0] - 5) * MODULE, (teeth[1] - 12) * MODULE
    gears = [
        Gear(
            z,
            MODULE,
            face_width=20e-3,
            bore_diameter=bore,
            normal_pressure_angle=PRESSURE_ANGLE,
            root_radius_coefficient=0.25,
            profile_shift_coefficient=shift,
        )
        for z, bore, shift in zip(teeth, bores, SHIFTS, strict=True)
    ]
    return GearPair(*gears, apart)


@pytest.mark.law
def test_the_edge_of_a_pointed_pinion(record_figure):
    """-0.56 and -0.38 % at worst before: it moves less along its flank than if the gear turned."""
    pair = pointed_pair()
    exact = solve_full_contact(pair, list(TORQUES), list(AT_EDGES)).transmission_error
    table = analyze(pair, torques=list(TORQUES), model="plane_strain", receipt="minimal")
    ours = np.array([table.curve(torque=torque, at=np.array(AT_EDGES)).ste for torque in TORQUES]).T
    worst = 100.0 * float(np.abs(ours / exact - 1.0).max())
    record_figure("STE at the edge of a pointed pinion", worst, "at most 0.17 %", "%", SOURCE)
    assert worst < 0.17
