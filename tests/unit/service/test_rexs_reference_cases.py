"""Cases of the example files that REXS publishes: every stage has one, and its geometry is the textbook's."""

from __future__ import annotations

import math

import pytest
from rexs_reference import examples, needs_reference

from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.gears import StageCase, stage_cases
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.rexs.upgrade import upgrade
from lineofaction.gearbox.schemas.case import PairInput

pytestmark = needs_reference
INDUSTRIAL = {(27, 51, 21.0): 1, (23, 34, -10.0): 1}
PLANETARY = {(17, 22, 0.0): 3, (22, 61, 0.0): 3}
SEW = {(23, 67, 30.0): 1, (13, 76, -10.0): 1, (14, 87, 10.0): 1}
STAGES = {"FVA-I": INDUSTRIAL, "FVA_P": PLANETARY, "SEW_3": SEW}
"""Teeth and helix angle of the driver, and the number of stages that are alike, by the name of the file."""

EXAMPLES = pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)


def opened(path: object) -> tuple[GearUnit, tuple[StageCase, ...]]:
    unit = GearUnit(upgrade(read_rexs(path).model)[0])  # type: ignore[arg-type]
    return unit, stage_cases(unit, {})


@EXAMPLES
def test_every_stage_has_its_case(path: object) -> None:
    _, cases = opened(path)
    found = {
        (pair.pinion.teeth, pair.wheel.teeth, pair.helix_angle_deg): 1 + len(case.equal)
        for case in cases
        for pair in [case.case.pair]
    }
    assert found == STAGES[path.name[:5]]  # type: ignore[attr-defined]
    assert len({case.name for case in cases}) == len(cases)


@EXAMPLES
def test_shifts_and_center_distances_of_a_file_agree(path: object) -> None:
    # A shift of the wrong sign or a wrong mate would open or jam the flanks by some tenths of a module.
    for stage in opened(path)[1]:
        pair = gear_pair(stage.case)
        assert abs(pair.transverse_base_backlash) <= 2e-4 * pair.pinion.normal_module


@EXAMPLES
def test_the_contact_ratio_is_the_textbooks(path: object) -> None:
    for stage in opened(path)[1]:
        ratio = gear_pair(stage.case).transverse_contact_ratio
        assert ratio == pytest.approx(contact_ratio(stage.case.pair), rel=1e-9)
        assert 1.1 < ratio < 2.0


def contact_ratio(pair: PairInput) -> float:
    """Return epsilon_alpha by tip diameters and center distance (ISO 21771-1)."""
    sign = -1.0 if pair.wheel.internal else 1.0
    cosine = math.cos(math.radians(pair.helix_angle_deg))
    pressure = math.atan(math.tan(math.radians(pair.normal_pressure_angle_deg)) / cosine)
    module = pair.normal_module_mm / cosine
    gears = ((pair.pinion.teeth, pair.pinion.tip_diameter_mm), (pair.wheel.teeth, pair.wheel.tip_diameter_mm))
    bases = [0.5 * teeth * module * math.cos(pressure) for teeth, _ in gears]
    rolls = [
        math.sqrt((0.5 * (tip or 0.0)) ** 2 - base**2) for (_, tip), base in zip(gears, bases, strict=True)
    ]
    working = math.acos(abs(bases[0] + sign * bases[1]) / pair.center_distance_mm)
    length = rolls[0] + sign * rolls[1] - sign * pair.center_distance_mm * math.sin(working)
    return length / (math.pi * module * math.cos(pressure))


@EXAMPLES
def test_each_gear_stage_and_flank_is_used(path: object) -> None:
    unit, _ = opened(path)
    kinds = ("cylindrical_gear", "ring_gear", "cylindrical_stage", "cylindrical_gear_flank", "flank_geometry")
    fates = [line.fate for line in unit.account.lines() if line.kind in kinds and not line.item]
    assert set(fates) <= {"taken", "derived"}
