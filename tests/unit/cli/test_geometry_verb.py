"""``loa geometry``: the data sheet against published and hand-worked values, and the drawing."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa
from matplotlib.path import Path as Polygon
from repository import EXAMPLES
from typer.testing import Result

from fe_contact.geometry.flank_tolerances import helix_tolerance, profile_tolerance
from fe_contact.plausibility import CHECKS
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.report.drawing.figure import Figure, Panel
from lineofaction.report.pair import pair_drawing

SPUR, HELICAL, INTERNAL = (
    EXAMPLES / f"{name}.toml" for name in ("palermo_spur_20_20", "sensitivity_automotive", "internal_gear")
)


def geometry(*arguments: object) -> Result:
    return loa("geometry", *arguments)


def sheet(file: Path) -> dict[str, dict[str, float]]:
    done = geometry(file, "--json")
    assert done.exit_code == 0, done.output
    return dict(json.loads(done.stdout))


def test_the_spur_pair_by_hand():
    """Module 4, 20/20, no shift: by formula, and the paper's contact ratio and base pitch."""
    found = sheet(SPUR)
    gear = {
        "reference_diameter_mm": 80.0,
        "base_diameter_mm": 80.0 * math.cos(math.radians(20.0)),
        "working_pitch_diameter_mm": 80.0,
        "tip_diameter_mm": 88.0,
        "root_diameter_mm": 70.0,
        "transverse_tooth_thickness_mm": 2.0 * math.pi,
        "tip_clearance_mm": 1.0,
    }
    for side in ("pinion", "wheel"):
        for name, value in gear.items():
            assert found[side][name] == pytest.approx(value, rel=1e-9), (side, name)
    mesh = found["mesh"]
    assert mesh["transverse_contact_ratio"] == pytest.approx(1.5568, abs=5e-5)
    assert mesh["transverse_base_pitch_mm"] == pytest.approx(11.809, abs=5e-4)
    assert mesh["working_pressure_angle_deg"] == pytest.approx(20.0, abs=1e-9)
    assert mesh["normal_backlash_um"] == pytest.approx(0.0, abs=1e-9)


def test_iso_tr_6336_30_example_1(tmp_path):
    """Published: m_t, d, eps_alpha 1.549, eps_beta 1.083 (ISO/TR 6336-30, example 1)."""
    file = tmp_path / "case.toml"
    file.write_text(
        "[pair]\nnormal_module_mm = 8\nhelix_angle_deg = 15.8\ncenter_distance_mm = 500\n"
        "[pair.pinion]\nteeth = 17\nface_width_mm = 100\nbore_diameter_mm = 50\n"
        "profile_shift_coefficient = 0.145\ndedendum_coefficient = 1.4\nroot_radius_coefficient = 0.39\n"
        "[pair.wheel]\nteeth = 103\nface_width_mm = 100\nbore_diameter_mm = 50\n"
        "dedendum_coefficient = 1.4\nroot_radius_coefficient = 0.39\n[load]\ntorque_n_m = [9000]\n"
    )
    found = sheet(file)
    assert found["mesh"]["transverse_contact_ratio"] == pytest.approx(1.549, abs=5e-4)
    assert found["mesh"]["overlap_ratio"] == pytest.approx(1.083, abs=5e-4)
    assert found["pinion"]["reference_diameter_mm"] == pytest.approx(141.34, abs=5e-3)
    assert found["wheel"]["reference_diameter_mm"] == pytest.approx(856.35, abs=5e-3)
    total = found["mesh"]["transverse_contact_ratio"] + found["mesh"]["overlap_ratio"]
    assert found["mesh"]["total_contact_ratio"] == total


def test_points_of_the_path_lie_a_pitch_apart_on_both_gears():
    for file in (SPUR, HELICAL, INTERNAL):
        found = sheet(file)
        points = found["path_of_contact"]
        for gear, side in enumerate(("pinion", "wheel")):
            radius = 0.5 * found[side]["base_diameter_mm"]
            roll = {name: math.radians(p["roll_angle_deg"][gear]) * radius for name, p in points.items()}
            pitch = found["mesh"]["transverse_base_pitch_mm"]
            assert abs(roll["E"] - roll["B"]) == pytest.approx(pitch, rel=1e-12)
            assert abs(roll["D"] - roll["A"]) == pytest.approx(pitch, rel=1e-12)
            for name, point in points.items():
                assert point["diameter_mm"][gear] == pytest.approx(2.0 * math.hypot(radius, roll[name]))
        assert points["A"]["diameter_mm"][0] == pytest.approx(found["pinion"]["active_root_diameter_mm"])
        assert points["E"]["diameter_mm"][1] == pytest.approx(found["wheel"]["active_root_diameter_mm"])


def test_the_table_holds_every_number_of_the_json_in_words():
    text, found = geometry(HELICAL).stdout, sheet(HELICAL)
    for name in ("tip_diameter_mm", "root_form_diameter_mm", "tip_clearance_mm"):
        for side in ("pinion", "wheel"):
            assert f"{found[side][name]:.4f}" in text, (side, name)
    assert f"{found['mesh']['total_contact_ratio']:.4f}" in text


def test_what_speaks_against_a_pair_is_said_and_decides_a_strict_exit_code():
    done = geometry(SPUR, "--strict")
    assert done.exit_code == 3
    assert "warning (backlash)" in done.stdout
    assert geometry(HELICAL, "--strict").exit_code == 0


def test_a_tip_near_the_mating_root_is_a_row_of_the_checks():
    assert "tip_clearance" not in geometry(SPUR).stdout
    done = geometry(SPUR, "--set", "pair.pinion.tip_diameter_mm=89.4")  # 0.3 mm of clearance, module 4 mm
    assert "warning (tip_clearance): pinion tip clearance over module = 0.075" in done.stdout
    assert CHECKS["tip_clearance"].source in " ".join(done.stdout.split())


def test_a_pointed_tooth_and_a_short_path_of_contact_are_rows_of_the_checks():
    said = geometry(SPUR).stdout
    assert "(tip_thickness)" not in said
    assert "(contact_ratio)" not in said
    shifts = {"pinion.profile_shift_coefficient": 1.0, "wheel.profile_shift_coefficient": -0.2}
    assert (
        "warning (tip_thickness): pinion tip thickness over module = 0.16"
        in geometry(SPUR, *overrides(shifts | {"center_distance_mm": 83.1})).stdout
    )
    stubs = {"pinion.tip_diameter_mm": 85.0, "wheel.tip_diameter_mm": 85.0}
    assert (
        "warning (contact_ratio): transverse contact ratio = 1.04" in geometry(SPUR, *overrides(stubs)).stdout
    )


def overrides(values: dict[str, float]) -> list[str]:
    return [part for name, value in values.items() for part in ("--set", f"pair.{name}={value}")]


@pytest.mark.parametrize("ending", ["png", "svg", "html"])
def test_a_drawing_is_written(ending, tmp_path):
    file = tmp_path / f"pair.{ending}"
    assert geometry(HELICAL, "-o", file).exit_code == 0
    assert file.read_bytes().startswith({"png": b"\x89PNG", "svg": b"<?xml", "html": b"<!DOCTYPE"}[ending])
    if ending == "html":
        assert "Data sheet" in file.read_text(encoding="utf-8")


def test_other_files_are_refused(tmp_path):
    done = geometry(HELICAL, "-o", tmp_path / "pair.pdf")
    assert done.exit_code == 2
    assert "ending in one of .html, .png, .svg" in done.stderr


def drawing(file: Path) -> Figure:
    return pair_drawing(gear_pair(read_model(Case, file)))


def section(file: Path) -> Panel:
    panels = drawing(file).content
    assert isinstance(panels, tuple)
    return panels[0]


@pytest.mark.parametrize("file", [SPUR, HELICAL, INTERNAL])
def test_drawn_flanks_touch_at_the_pitch_point_and_do_not_overlap(file):
    panel = section(file)
    gears = {
        line.name: np.column_stack((line.x, line.y))
        for line in panel.lines
        if line.name in ("pinion", "wheel")
    }
    pitch_point = next(note for note in panel.notes if note.text == "C")
    for outline in gears.values():
        steps = np.linspace(outline[:-1], outline[1:], 50).reshape(-1, 2)  # along the drawn strokes
        assert np.min(np.hypot(steps[:, 0] - pitch_point.x, steps[:, 1] - pitch_point.y)) < 0.02
    (left, right), (bottom, top) = panel.x.limits, panel.y.limits
    x, y = gears["pinion"].T
    seen = gears["pinion"][(x > left) & (x < right) & (y > bottom) & (y < top)]
    assert len(seen) > 100
    inside = Polygon(gears["wheel"]).contains_points(seen)
    overlapping = seen[~inside if file is INTERNAL else inside]
    strokes = np.linspace(gears["wheel"][:-1], gears["wheel"][1:], 50).reshape(-1, 2)
    depths = [np.min(np.hypot(*(strokes - point).T)) for point in overlapping]
    assert max(depths, default=0.0) < 0.005  # mm; strokes are chords of curved flanks


def test_charts_show_what_is_removed_and_only_of_modified_flanks(tmp_path):
    plain = drawing(SPUR).content
    assert isinstance(plain, tuple)
    assert [panel.title for panel in plain] == ["Transverse section"]
    file = tmp_path / "case.toml"
    added = "[pair.wheel]\ntip_relief_um = 20\ntip_relief_length_mm = 1.0\nhelix_crowning_um = 8"
    file.write_text(SPUR.read_text().replace("[pair.wheel]", added))
    panels = drawing(file).content
    assert isinstance(panels, tuple)
    _, profile, lead = panels
    assert profile.title.startswith("Profile of the wheel")
    (curve,) = profile.lines
    assert curve.y[0] == 0.0
    assert curve.y[-1] == pytest.approx(20.0)
    assert curve.x[-1] == pytest.approx(math.degrees(math.sqrt((88 / 75.17540966) ** 2 - 1.0)), rel=1e-7)
    (along,) = lead.lines
    assert along.y[[0, 100, 200]] == pytest.approx((8.0, 0.0, 8.0))


def test_charts_show_teeth_as_made_beside_the_design():
    """A slope of the profile lifts the tip by half of it, one of the helix the end of larger z."""
    case = read_model(Case, SPUR).model_dump(exclude_unset=True)
    sloping = [{"tooth": 3, "profile_slope_um": 6.0}, {"tooth": 7, "helix_slope_um": -4.0}]
    case["pair"]["wheel"] |= {"tooth_flanks": sloping}
    _, profile, lead = pair_drawing(gear_pair(Case.model_validate(case))).content
    design, made = profile.lines
    assert set(design.y) == {0.0}
    assert made.y[[0, 100, 200]] == pytest.approx((3.0, 0.0, -3.0), abs=1e-6)
    assert np.isnan(made.y[[201, 403]]).all() and set(made.y[202:403]) == {0.0}
    assert lead.lines[1].y[[202, 302, 402]] == pytest.approx((-2.0, 0.0, 2.0), abs=1e-6)


def modified(file: Path, **errors: Any) -> dict[str, Any]:
    case = read_model(Case, file).model_dump(exclude_unset=True)
    made = [{"tooth": 3, "profile_slope_um": 6.0, "helix_slope_um": -4.0}]
    for gear in ("pinion", "wheel"):
        case["pair"][gear] |= {"tip_relief_um": 12.0, "tip_relief_length_mm": 0.8, "helix_crowning_um": 5.0}
        case["pair"][gear] |= {"tooth_flanks": made}
    return case | {"errors": errors}


@pytest.mark.parametrize("file", [SPUR, HELICAL])
def test_the_band_about_profile_and_lead_is_the_tolerance_of_the_class(file):
    """Half to each side of the design; the teeth as made are drawn over it without one."""
    pair = gear_pair(Case.model_validate(modified(file)))
    figure = pair_drawing(pair, 7)
    _, *profiles, lead = figure.content
    for panel, gear in zip(profiles, (pair.pinion, pair.wheel), strict=True):
        design, made = panel.lines
        assert 2e-6 * design.band == pytest.approx(profile_tolerance(gear, 7), rel=1e-12)
        assert made.name.endswith("as made") and not made.has_band
    for line, gear in zip(lead.lines[::2], (pair.pinion, pair.wheel), strict=True):
        assert 2e-6 * line.band == pytest.approx(helix_tolerance(gear, 7), rel=1e-12)
    assert "F_alpha and F_beta of class 7 of ISO 1328-1:2013" in figure.caption


def test_without_a_class_nothing_is_shaded():
    figure = pair_drawing(gear_pair(Case.model_validate(modified(HELICAL))))
    assert not any(line.has_band for panel in figure.content for line in panel.lines)
    assert "Shaded" not in figure.caption


def test_the_page_of_a_case_with_a_class_says_it(tmp_path):
    for errors in ({"misalignment_class": 7}, {}):
        file = tmp_path / "case.toml"
        file.write_text(toml_text(modified(HELICAL, **errors)), encoding="utf-8")
        assert geometry(file, "-o", tmp_path / "pair.html").exit_code == 0
        page = (tmp_path / "pair.html").read_text(encoding="utf-8")
        assert ("F_beta of class 7" in page) == bool(errors)


@pytest.mark.parametrize(("hand", "corner"), [(1.0, "non-datum face"), (-1.0, "datum face")])
def test_a_triangular_relief_is_drawn_at_the_face_that_lines_of_contact_leave_last(hand, corner):
    """At the tip of a right-hand driver they leave at the non-datum face, at that of a left-hand one."""
    case = read_model(Case, HELICAL).model_dump(exclude_unset=True)
    case["pair"]["helix_angle_deg"] = hand * abs(case["pair"]["helix_angle_deg"])
    relief = {"triangular_tip_relief_um": 20.0, "triangular_tip_relief_length_mm": 0.8}
    plain = {key: case["pair"]["pinion"][key] for key in ("teeth", "face_width_mm", "bore_diameter_mm")}
    shift = case["pair"]["pinion"].get("profile_shift_coefficient", 0.0)
    case["pair"]["pinion"] = plain | relief | {"profile_shift_coefficient": shift}
    panel = pair_drawing(gear_pair(Case.model_validate(case))).content[1]
    at_tip = {line.name: line.y[-1] for line in panel.lines}
    other = next(name for name in ("datum face", "non-datum face") if name != corner)
    assert at_tip[f"pinion, {corner}"] == pytest.approx(20.0)
    assert at_tip[f"pinion, {other}"] == 0.0
