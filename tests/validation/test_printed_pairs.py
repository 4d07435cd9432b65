"""Gear pairs typed as they are printed are computed; what rounding makes is told from what jams."""

import csv
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fe_contact.analysis.analyze import analyze
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.geometry.backlash import base_circle_backlash
from fe_contact.geometry.printed_data import (
    CENTER_DISTANCE,
    HELIX_ANGLE,
    NORMAL_MODULE,
    PROFILE_SHIFT,
    backlash_rounding,
)
from fe_contact.involute import involute_function
from lineofaction.gearbox.convert.case import analysis_options, gear_pair, table_axes
from lineofaction.gearbox.schemas import Case, validated

FILE = Path(__file__).parents[1] / "reference" / "printed_pairs.csv"
RACK = ("addendum_coefficient", "dedendum_coefficient", "root_radius_coefficient")
Row = dict[str, str]


def printed_pairs() -> list[Row]:
    with FILE.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def printed_case(row: Row, model: str = "auto") -> Case:
    """Return the case of a row, every number as it is printed, at 100 N per mm of face and mm of module."""
    module, width = float(row["normal_module_mm"]), float(row["face_width_mm"])
    shared = ("normal_module_mm", "normal_pressure_angle_deg", "helix_angle_deg", "center_distance_mm")
    pair = {name: float(row[name]) for name in shared}
    pair |= {"pinion": _gear(row, 1), "wheel": _gear(row, 2)}
    accuracy = {"level": "draft", "model": model, "receipt": "minimal"}
    load = {"normal_force_n": [100.0 * module * width]}
    return validated(Case, {"pair": pair, "load": load, "accuracy": accuracy})


def _gear(row: Row, index: int) -> dict[str, Any]:
    """Return one gear of a row; a negative number of teeth is a ring gear."""
    teeth, module = int(row[f"teeth_{index}"]), float(row["normal_module_mm"])
    diameter = abs(teeth) * module
    gear: dict[str, Any] = {
        "teeth": abs(teeth),
        "face_width_mm": float(row["face_width_mm"]),
        "profile_shift_coefficient": float(row[f"x_{index}"]),
    }
    if tip := row[f"tip_diameter_{index}_mm"]:
        gear["tip_diameter_mm"] = float(tip)
    rack = {name: float(row[name]) for name in RACK if row[name]}
    if teeth > 0:
        return gear | rack | {"bore_diameter_mm": round(0.4 * diameter, 1)}
    rack.pop("root_radius_coefficient", None)  # that of the pinion's rack; a ring's is its cutter's
    return gear | rack | {"internal": True, "rim_diameter_mm": round(diameter + 14.0 * module, 1)}


PAIRS = printed_pairs()


def names(row: Row) -> str:
    return row["name"].replace(" ", "_").replace("/", "_").replace(",", "")


def computed_backlash(pair: ParallelAxes) -> float:
    """Return backlash of the numbers as they are, negative where rounding makes them jam."""
    return base_circle_backlash(pair.pinion, pair.wheel, pair.working_pressure_angle)


def jams_most(row: Row) -> float:
    pair = gear_pair(printed_case(row))
    return computed_backlash(pair) / pair.pinion.normal_module


def test_forty_pairs_of_several_sources_are_there():
    published = [row for row in PAIRS if row["kind"] == "published"]
    assert len(PAIRS) >= 40
    assert len(published) >= 25
    assert len({row["source"].split(",")[0] for row in published}) >= 10
    helical = [row for row in PAIRS if float(row["helix_angle_deg"])]
    internal = [row for row in PAIRS if row["teeth_2"].startswith("-")]
    assert len(helical) >= 12
    assert len(internal) >= 6
    assert sum(jams_most(row) < -1e-6 for row in PAIRS) >= 12


@pytest.mark.parametrize("row", PAIRS, ids=names)
def test_a_printed_pair_is_accepted_with_the_backlash_it_has(row):
    pair = gear_pair(printed_case(row))
    computed = computed_backlash(pair)
    rounding = backlash_rounding(pair.pinion, pair.wheel, pair.center_distance)
    assert -rounding - 1e-12 * pair.center_distance <= computed <= rounding + 1e-12 * pair.center_distance
    assert pair.transverse_base_backlash == max(computed, 0.0)
    assert pair.normal_backlash >= 0.0


@pytest.mark.parametrize("row", PAIRS, ids=names)
def test_teeth_that_are_too_thick_are_accepted_up_to_the_rounding_and_refused_beyond(row):
    pair = gear_pair(printed_case(row))
    shifts = [gear.profile_shift_coefficient for gear in (pair.pinion, pair.wheel)]
    digit = 2.0 * PROFILE_SHIFT.rounding(*shifts) or 1e-4
    kept_tip = replace(pair.wheel, tip_diameter=2.0 * pair.wheel.tip_radius)
    for steps in range(1, 400):
        wheel = replace(kept_tip, profile_shift_coefficient=round(shifts[1] + steps * digit, 6))
        jam = -base_circle_backlash(pair.pinion, wheel, pair.working_pressure_angle)
        if jam > largest_rounding(pair, wheel):
            with pytest.raises(InfeasibleGeometry, match="where the teeth jam"):
                replace(pair, wheel=wheel)
            return
        assert replace(pair, wheel=wheel).transverse_base_backlash == max(-jam, 0.0)
    pytest.fail("no thickness is refused")


def largest_rounding(pair: ParallelAxes, wheel: Toothing) -> float:
    """Return the most that half of each last digit changes the backlash, by moving the printed values."""
    pinion = pair.pinion
    shifts = (pinion.profile_shift_coefficient, wheel.profile_shift_coefficient)
    values = (pinion.normal_module, pinion.helix_angle, pair.center_distance, *shifts)
    half_shift = PROFILE_SHIFT.rounding(*(shift for shift in shifts if shift))
    halves = (
        NORMAL_MODULE.rounding(values[0]),
        HELIX_ANGLE.rounding(values[1]),
        CENTER_DISTANCE.rounding(values[2]),
        *(half_shift if shift else 0.0 for shift in shifts),
    )

    def moved(index, by):
        return nominal_backlash(pair, *(value + by * (i == index) for i, value in enumerate(values)))

    return sum(0.5 * abs(moved(i, half) - moved(i, -half)) for i, half in enumerate(halves))


def nominal_backlash(pair: ParallelAxes, m_n: float, beta: float, a: float, x_1: float, x_2: float) -> float:
    """Return the backlash along the transverse line of action of printed values, m."""
    tangent, teeth = math.tan(pair.pinion.normal_pressure_angle), pair.wheel.sign * pair.wheel.teeth
    transverse = math.atan(tangent / math.cos(beta))
    base_module = m_n / math.cos(beta) * math.cos(transverse)
    total = pair.pinion.teeth + teeth
    working = math.acos(0.5 * base_module * abs(total) / a)
    inv = involute_function
    return base_module * (total * (inv(working) - inv(transverse)) - 2.0 * (x_1 + x_2) * tangent)


def test_the_printed_pair_that_jams_most_gets_its_table():
    row = min(PAIRS, key=jams_most)
    assert not float(row["helix_angle_deg"])
    check_table(row, "plane_strain")


@pytest.mark.nightly
@pytest.mark.parametrize("row", PAIRS, ids=names)
def test_a_printed_pair_gets_its_table(row):
    check_table(row, "auto")


def check_table(row: Row, model: str) -> None:
    case = printed_case(row, model)
    pair = gear_pair(case)
    table = analyze(pair, table_axes(case), analysis_options(case))
    assert (table.status == 0).all()
    assert table.static_transmission_error.min() > 0.0
    notes = [one["reason"] for one in table.metadata.receipt["assumptions"]]
    assert any("rounding of the printed data" in note for note in notes) == (pair.rounding_jam > 1e-9)
