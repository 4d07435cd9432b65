"""Nonsense cases are refused or warned of by name; ordinary ones are let through without a word."""

from __future__ import annotations

import copy
import math
import re
from pathlib import Path
from typing import Any

import pytest

from bounds import engineering
from dynamics.plausibility import CHECKS as SCENE_CHECKS
from fe_contact.plausibility import CHECKS as PAIR_CHECKS
from lineofaction.gearbox.convert.case import CheckedCase, check_case
from lineofaction.gearbox.convert.plausibility import case_warnings
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.units import DEGREE, GPA, MM, UM

EXAMPLES = Path(__file__).parents[3] / "examples"
CASE_FILES = [file for file in sorted(EXAMPLES.rglob("*.toml")) if "[pair]" in file.read_text("utf-8")]
SPUR = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.0,
        "pinion": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
        "wheel": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
    },
    "load": {"torque_n_m": [100.0, 400.0]},
}
METRES = {
    "pair.normal_module_mm": 0.004,
    "pair.center_distance_mm": 0.08,
    **{
        f"pair.{gear}.{field}": value
        for gear in ("pinion", "wheel")
        for field, value in (("face_width_mm", 0.025), ("bore_diameter_mm", 0.04))
    },
}
RELIEF = "pair.pinion.tip_relief_um"
LENGTH = "pair.pinion.tip_relief_length_mm"
SHAFT = {"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": 100.0}
WIDE = {"pair.pinion.face_width_mm": 1000.0, "pair.wheel.face_width_mm": 1000.0}

# name, changes, field, check (None: refused), unit asked about
NONSENSE: list[tuple[str, dict[str, Any], str, str | None, str]] = [
    ("the whole case in meters", METRES, "pair.normal_module_mm", "module", "meters"),
    ("the module in meters", {"pair.normal_module_mm": 0.004}, "pair.pinion.bore_diameter_mm", None, ""),
    ("the module in inches", {"pair.normal_module_mm": 0.157}, "pair.pinion.bore_diameter_mm", None, ""),
    ("the center distance in meters", {"pair.center_distance_mm": 0.08}, "pair.center_distance_mm", None, ""),
    ("torque in kN m", {"load.torque_n_m": [0.01, 0.1]}, "load.torque_n_m[1]", "light_load", "kN m"),
    ("torque in N mm", {"load.torque_n_m": [1e4, 1e5]}, "load.torque_n_m[1]", "line_load", "N mm"),
    (
        "a rated torque that no gear has",
        {"load.torque_n_m": [3000.0]},
        "load.torque_n_m[0]",
        "hertz_pressure",
        "",
    ),
    (
        "a torque that breaks the teeth",
        {"load.torque_n_m": [3000.0]},
        "load.torque_n_m[0]",
        "root_stress",
        "",
    ),
    ("force in kN", {"load": {"normal_force_n": [2.66]}}, "load.normal_force_n[0]", "light_load", "kN"),
    ("a face of 1000 mm", WIDE, "pair.pinion.face_width_mm", "face_width", ""),
    (
        "a face in meters",
        {"pair.pinion.face_width_mm": 0.025, "pair.wheel.face_width_mm": 0.025},
        "pair.pinion.face_width_mm",
        "face_width",
        "meters",
    ),
    (
        "Young's modulus in MPa",
        {"material": {"youngs_modulus_gpa": 210e3}},
        "material.youngs_modulus_gpa",
        None,
        "",
    ),
    (
        "Young's modulus in Pa",
        {"material": {"youngs_modulus_gpa": 210e9}},
        "material.youngs_modulus_gpa",
        None,
        "",
    ),
    (
        "Young's modulus of a plastic in MPa",
        {"material": {"youngs_modulus_gpa": 1500.0}},
        "material.youngs_modulus_gpa",
        "youngs_modulus",
        "MPa",
    ),
    ("relief in mm", {RELIEF: 0.02, LENGTH: 1.5}, RELIEF, "relief_amount", "millimeters"),
    ("relief in m", {RELIEF: 2e-5, LENGTH: 1.5}, RELIEF, "relief_amount", "meters"),
    ("relief in tenths of um", {RELIEF: 900.0, LENGTH: 1.5}, RELIEF, "relief_over_module", ""),
    ("length of the relief in m", {RELIEF: 20.0, LENGTH: 0.0015}, LENGTH, "relief_length", "meters"),
    (
        "allowance in mm",
        {"pair.pinion.thickness_allowance_um": 0.05},
        "pair.pinion.thickness_allowance_um",
        "relief_amount",
        "millimeters",
    ),
    (
        "crowning in mm",
        {"pair.wheel.helix_crowning_um": 0.01},
        "pair.wheel.helix_crowning_um",
        "relief_amount",
        "millimeters",
    ),
    (
        "misalignment in mm",
        {"errors": {"misalignment_um": [0.0, 0.02]}},
        "errors.misalignment_um[1]",
        "misalignment",
        "millimeters",
    ),
    (
        "misalignment in nm",
        {"errors": {"misalignment_um": [0.0, 9000.0]}},
        "errors.misalignment_um[1]",
        "misalignment_over_face",
        "",
    ),
    (
        "center distance change in m",
        {"errors": {"center_distance_change_mm": [0.0, 5e-5]}},
        "errors.center_distance_change_mm[1]",
        "center_distance_change",
        "meters",
    ),
    (
        "center distance change in um",
        {"errors": {"center_distance_change_mm": [0.0, 50.0]}},
        "errors.center_distance_change_mm[1]",
        None,
        "",
    ),
    (
        "a bore beyond the root",
        {"pair.pinion.bore_diameter_mm": 72.0},
        "pair.pinion.bore_diameter_mm",
        None,
        "",
    ),
    (
        "a bore in meters",
        {"pair.pinion.bore_diameter_mm": 0.04},
        "pair.pinion.bore_diameter_mm",
        "bore",
        "meters",
    ),
    (
        "helix in radians",
        {"pair.helix_angle_deg": 0.35, "pair.center_distance_mm": 80.0015},
        "pair.helix_angle_deg",
        "helix_angle",
        "radians",
    ),
    (
        "pressure angle in radians",
        {"pair.normal_pressure_angle_deg": 0.349},
        "pair.normal_pressure_angle_deg",
        None,
        "",
    ),
    (
        "shaft length in m",
        {"pair.pinion.shaft": SHAFT | {"length_mm": 0.2, "position_mm": 0.1}},
        "pair.pinion.shaft.length_mm",
        "shaft_slenderness",
        "meters",
    ),
    (
        "bearing stiffness in N/mm",
        {"pair.pinion.shaft": SHAFT | {"bearing_stiffness_n_per_um": 4e5}},
        "pair.pinion.shaft.bearing_stiffness_n_per_um",
        "bearing_stiffness",
        "N/mm",
    ),
    (
        "bearing stiffness in N/m",
        {"pair.pinion.shaft": SHAFT | {"bearing_stiffness_n_per_um": 4e8}},
        "pair.pinion.shaft.bearing_stiffness_n_per_um",
        "bearing_stiffness",
        "N/m",
    ),
]


def changed(changes: dict[str, Any]) -> Case:
    content = copy.deepcopy(SPUR)
    for path, value in changes.items():
        *tables, last = path.split(".")
        table: dict[str, Any] = content
        for name in tables:
            table = table.setdefault(name, {})
        table[last] = value
    return validated(Case, content)


@pytest.mark.parametrize(
    ("changes", "field", "check", "asked"), [n[1:] for n in NONSENSE], ids=[n[0] for n in NONSENSE]
)
def test_nonsense_is_refused_or_warned_of_by_name(
    changes: dict[str, Any], field: str, check: str | None, asked: str
) -> None:
    """By the caller's field, in the caller's unit, with the unit that was most likely meant."""
    if check is None:
        with pytest.raises(BadInput) as refusal:
            check_case(changed(changes))
        assert field in [fault.field for fault in refusal.value.faults]
        return
    case = changed(changes)
    check_case(case)
    found = {(warning["check"], warning["field"]): warning for warning in case_warnings(CheckedCase(case))}
    warning = found[check, field]
    assert warning["message"].startswith(f"{field} = ")
    question = warning["message"].partition("Did you give ")[2]
    assert question.startswith(asked) if asked else not question


def test_at_least_25_cases_are_nonsense() -> None:
    assert len(NONSENSE) >= 25


def test_a_case_in_meters_is_one_warning_for_all_its_lengths() -> None:
    """Loads and faces follow from the lengths: they would hide the cause."""
    (warning,) = case_warnings(CheckedCase(changed(METRES)))
    assert warning["message"].endswith("Did you give meters, here and in all other lengths?")
    assert (warning["value"], warning["unit"]) == (0.004, "mm")


def test_the_spur_pair_itself_is_plausible() -> None:
    assert case_warnings(CheckedCase(changed({}))) == []


@pytest.mark.parametrize("file", CASE_FILES, ids=lambda file: file.stem)
def test_examples_are_plausible(file: Path) -> None:
    assert case_warnings(CheckedCase(read_model(Case, file))) == []


def ordinary(
    module: float,
    teeth: tuple[int, int],
    *,
    ratio: float,
    helix: float = 0.0,
    stress: float = 50.0,
    modulus: float = 210.0,
    **pair: Any,
) -> Case:
    """Return a pair whose largest load is `stress` N/mm^2 over face width and module."""
    cosine, internal = math.cos(math.radians(helix)), pair.pop("internal", False)
    width, diameter = ratio * module, module * teeth[0] / cosine
    distance = 0.5 * module * (teeth[1] - teeth[0] if internal else sum(teeth)) / cosine
    wheel: dict[str, Any] = {"teeth": teeth[1], "face_width_mm": width}
    if internal:
        wheel |= {"internal": True, "rim_diameter_mm": module * (teeth[1] + 10), "addendum_coefficient": 0.9}
    else:
        wheel["bore_diameter_mm"] = 0.5 * module * teeth[1]
    torque = stress * width * module * 0.5 * diameter * 1e-3
    content = {
        "pair": {
            "normal_module_mm": module,
            "helix_angle_deg": helix,
            "center_distance_mm": distance,
            "pinion": {"teeth": teeth[0], "face_width_mm": width, "bore_diameter_mm": 0.5 * module * teeth[0]}
            | pair,
            "wheel": wheel,
        },
        "material": {"youngs_modulus_gpa": modulus},
        "load": {"torque_n_m": [torque]},
    }
    return validated(Case, content)


@pytest.mark.parametrize("module", [0.3, 0.5, 1.0, 2.5, 6.0, 12.0, 25.0])
@pytest.mark.parametrize("stress", [0.2, 10.0, 150.0, 300.0], ids=lambda value: f"{value} N/mm^2")
def test_ordinary_pairs_are_plausible(module: float, stress: float) -> None:
    """From module 0.3 to 25, spur and helical, nearly idle, rated and raced."""
    for helix, ratio in ((0.0, 10.0), (15.0, 20.0), (30.0, 35.0)):
        assert (
            case_warnings(CheckedCase(ordinary(module, (23, 61), ratio=ratio, helix=helix, stress=stress)))
            == []
        )


@pytest.mark.parametrize(("modulus", "stress"), [(1.2, 4.0), (3.0, 12.0), (10.0, 20.0), (110.0, 40.0)])
def test_plastics_and_bronze_are_plausible(modulus: float, stress: float) -> None:
    assert (
        case_warnings(CheckedCase(ordinary(1.0, (25, 40), ratio=8.0, stress=stress, modulus=modulus))) == []
    )


@pytest.mark.parametrize("stress", [0.2, 100.0])
def test_internal_pairs_are_plausible(stress: float) -> None:
    assert case_warnings(CheckedCase(ordinary(2.0, (36, 96), ratio=10.0, stress=stress, internal=True))) == []


def test_fine_modifications_and_deviations_are_plausible() -> None:
    """1 um of crowning on a small gear, 60 um of relief and 2 mrad on a large one."""
    small = ordinary(
        0.5, (23, 40), ratio=10.0, helix_crowning_um=1.0, tip_relief_um=2.0, tip_relief_length_mm=0.1
    )
    large = ordinary(
        12.0,
        (23, 61),
        ratio=20.0,
        tip_relief_um=120.0,
        tip_relief_length_mm=6.0,
        thickness_allowance_um=200.0,
    )
    assert case_warnings(CheckedCase(small)) == case_warnings(CheckedCase(large)) == []


DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "plausibility.md").read_text(encoding="utf-8")


def limits(check: Any) -> str:
    low, high = limit_text(check.low, check.unit), limit_text(check.high, check.unit)
    if low and high:
        return f"{low} to {high} ({check.source})."
    if not low + high:
        return f"{check.source[0].upper()}{check.source[1:]}."
    return f"{f'At least {low}' if low else f'At most {high}'} ({check.source})."


@pytest.mark.parametrize(
    "check", [*PAIR_CHECKS.values(), *SCENE_CHECKS.values()], ids=lambda check: check.name
)
def test_every_check_is_on_the_page(check: Any) -> None:
    assert f"`{check.name}`: {check.quantity} : {limits(check)}" in " ".join(PAGE.split())


def test_the_page_has_no_check_that_is_gone() -> None:
    listed = re.findall(r"^`(\w+)`: ", PAGE, re.MULTILINE)
    assert sorted(listed) == sorted([*PAIR_CHECKS, *SCENE_CHECKS])


def test_the_page_is_linked() -> None:
    assert "(plausibility.md)" in (DOCS / "cli.md").read_text(encoding="utf-8")


def limit_text(limit: float | None, unit: str) -> str:
    """Return a limit of a check as people read it; empty for none."""
    if limit is None:
        return ""
    small, soft = limit < 1e-3, limit < 1e9
    scales = {
        "m": (UM, "um") if small else (MM, "mm"),
        "Pa": (1e6, "MPa") if soft else (GPA, "GPa"),
        "rad": (DEGREE, "deg"),
        "1": (1.0, ""),
    }
    scale, name = scales.get(unit, (1.0, unit))
    return f"{engineering(limit / scale, 3)} {name}".strip()
