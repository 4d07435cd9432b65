"""From a case to the library: every unit, field and grid of a flank, and errors in the user's words."""

import json
import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from bad_inputs import GOOD
from changed_scenes import assert_refused, changed
from spur_case import spur_case

from bounds import Kind
from fe_contact import AllowedError, FlankModification
from fe_contact.flank.drawing_starts import DrawingStarts
from lineofaction.gearbox.convert.case import analysis_options, case_json, gear_pair, table_axes, with_flanks
from lineofaction.gearbox.convert.checked_case import check_case
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.gear import with_figures
from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.examples import CASE
from service.worker.process import content_key


def case(**pinion: Any) -> Case:
    return changed_case({f"pair.pinion.{name}": value for name, value in pinion.items()})


def changed_case(changes: dict[str, Any]) -> Case:
    return validated(Case, changed(GOOD, changes))


MODIFIED: dict[str, Any] = {
    figure.field: figure.boundary_value(figure.what.example)
    for figure in figures(FlankModification)
    if not figure.name.startswith(("triangular", "tip_rounding"))  # of helical gears, in place of a chamfer
}


def test_lengths_and_angles_become_si():
    pair = gear_pair(case(thickness_allowance_um=50.0, tip_diameter_mm=87.5))
    assert pair.center_distance == pytest.approx(0.08, rel=1e-15)
    assert pair.pinion.normal_module == pytest.approx(0.004, rel=1e-15)
    assert pair.pinion.normal_pressure_angle == pytest.approx(math.radians(20.0), rel=1e-15)
    assert pair.pinion.thickness_allowance == pytest.approx(5e-5, rel=1e-15)
    assert pair.pinion.tip_diameter == pytest.approx(0.0875, rel=1e-15)
    assert pair.wheel.tip_diameter is None


STARTED = {"tip_relief_um": 12.0, "tip_relief_start_diameter_mm": 86.0}
"""A relief by where it starts, which a length replaces."""


@pytest.mark.law
@pytest.mark.parametrize("name", [*MODIFIED, "tip_rounding_mm"])
@pytest.mark.parametrize("before", [{}, STARTED], ids=["plain", "started"])
def test_other_flanks_make_the_pair_of_the_case_that_states_them(name, before):
    """Of either gear, to the last bit; what no pair can have is refused in the same words."""
    stem = name.removesuffix("_um").removesuffix("_shape")
    change = {other: value for other, value in MODIFIED.items() if other.startswith(stem)}
    change |= {} if name in MODIFIED else {name: 0.2}
    stated = changed_case({f"pair.pinion.{field}": value for field, value in before.items()})
    pair, whole = gear_pair(stated), stated.model_dump(mode="json")
    for gear in ("pinion", "wheel"):
        anew = whole["pair"] | {gear: with_figures(whole["pair"][gear], change)}

        def expected(table=anew):
            return gear_pair(validated(Case, whole | {"pair": table}))

        assert _made(lambda own=gear: with_flanks(pair, stated, {own: change})) == _made(expected)


def _made(pair: Any) -> Any:
    try:
        return pair()
    except BadInput as error:
        return error.faults


def test_a_pair_without_other_flanks_stays_the_same():
    stated = case(**STARTED)
    pair = gear_pair(stated)
    assert with_flanks(pair, stated, {"pinion": {}, "wheel": {}}) is pair
    assert with_flanks(pair, stated, {"pinion": {"tip_relief_um": 1.0}}).wheel is pair.wheel


def test_a_gear_without_modifications_is_the_librarys_own_default():
    """To the last bit, angles with the rest: equal pairs have equal hashes."""
    assert gear_pair(case()).pinion.modification == FlankModification()


def test_every_field_of_the_gear_schema_reaches_the_gear():
    """A field that conversion forgets would leave the gear as it is; corners: test_declared_fields."""
    plain = gear_pair(case()).pinion
    changes: dict[str, Any] = {
        "teeth": 21,
        "face_width_mm": 24.0,
        "bore_diameter_mm": 39.0,
        "profile_shift_coefficient": 0.05,
        "addendum_coefficient": 0.9,
        "dedendum_coefficient": 1.2,
        "root_radius_coefficient": 0.3,
        "tip_diameter_mm": 87.0,
        "thickness_allowance_um": 100.0,
        "tooth_thinning": "flank",
        "pitch_deviation_um": [1.0] * 20,
        "single_pitch_deviation_um": [1.0, *19 * [0.0]],
        "tooth_flanks": [{"tooth": 3, "profile_slope_um": 2.0}],
        "run_out": {"eccentricity_um": 5.0},
        "waves": [{"order": 11, "amplitude_um": 0.2}],
        "tip_rounding_mm": 0.2,
        "material": {"youngs_modulus_gpa": 100.0},
        "seat": {"tangential_foundation_n_per_mm3": 1e4},
        "sector_teeth": 7,
        "blank": {"rim_thickness_mm": 8.0, "web_thickness_mm": 10.0},
        "shaft": {"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": 60.0},
        "flank_grid": {
            "roll_length_mm": [4.0, 20.0],
            "face_position_mm": [-12.5, 12.5],
            "removed_um": [[0.0, 0.0], [5.0, 7.0]],
        },
    }
    shapes = {figure.field for figure in figures(FlankModification, Kind.SHAPE)}
    corners = {figure.field for figure in figures(FlankModification) if figure.name.startswith("triangular")}
    starts = {figure.field for figure in figures(DrawingStarts)}  # test_stated_starts
    covered = set(changes) | set(MODIFIED) | shapes | corners | starts
    assert covered == set(type(case().pair.pinion).model_fields)
    for name, value in changes.items():
        distance = 82.1 if name == "teeth" else 80.2
        pair = gear_pair(changed_case({f"pair.pinion.{name}": value, "pair.center_distance_mm": distance}))
        assert (pair.pinion, pair.shafts[0]) != (plain, None), name


def test_rim_web_and_hub_arrive_in_si_and_their_errors_in_mm():
    given = {
        "rim_thickness_mm": 8.0,
        "web_thickness_mm": 10.0,
        "hub_diameter_mm": 45.0,
        "web_offset_mm": -2.0,
    }
    blank = gear_pair(case(blank=given)).pinion.blank
    found = (blank.rim_thickness, blank.web_thickness, blank.hub_diameter, blank.web_offset)
    assert found == pytest.approx((8e-3, 10e-3, 45e-3, -2e-3), rel=1e-15)
    with assert_refused("pair.pinion.blank.rim_thickness_mm", "12.5 mm") as faults:
        gear_pair(case(blank=given | {"rim_thickness_mm": 20.0}))
    assert faults[0].value == pytest.approx(20.0)


def test_a_seat_arrives_in_si_and_its_errors_in_mm():
    given = {
        f"{name}_foundation_n_per_mm3": 1e3 * i for i, name in enumerate(("radial", "tangential", "axial"), 1)
    }
    key = {"width_mm": 12.0, "angle_deg": 180.0}
    seat = gear_pair(case(seat=given | {"width_mm": 20.0, "offset_mm": -2.0, "key": key})).pinion.seat
    assert (seat.key.width, seat.key.angle) == (pytest.approx(12e-3, rel=1e-15), math.pi)
    assert seat.key_modulus == pytest.approx(2e12, rel=1e-15)
    seat = replace(seat, key=None)
    assert seat.stiffness == pytest.approx((1e12, 2e12, 3e12), rel=1e-15)
    assert (seat.width, seat.offset) == pytest.approx((20e-3, -2e-3), rel=1e-15)
    with assert_refused("pair.pinion.seat.width_mm", "25 mm") as faults:
        gear_pair(case(seat={"width_mm": 30.0}))
    assert faults[0].value == pytest.approx(30.0)
    with assert_refused("pair.pinion.seat.tangential_foundation_n_per_mm3"):
        gear_pair(case(seat={"key": key}))
    with assert_refused("pair.pinion.seat.key.width_mm"):
        gear_pair(case(seat=given | {"key": key | {"width_mm": 200.0}}))


def test_mating_gears_have_opposite_hands():
    distance = 80.0 / math.cos(math.radians(15.0))
    pair = gear_pair(changed_case({"pair.helix_angle_deg": 15.0, "pair.center_distance_mm": distance}))
    assert pair.pinion.helix_angle == pytest.approx(math.radians(15.0))
    assert pair.wheel.helix_angle == -pair.pinion.helix_angle


def test_a_gears_own_material_wins():
    own = {"youngs_modulus_gpa": 3.0, "poissons_ratio": 0.4}
    pair = gear_pair(changed_case({"material.youngs_modulus_gpa": 206.0, "pair.wheel.material": own}))
    assert pair.pinion.material.youngs_modulus == pytest.approx(206e9)
    assert (pair.wheel.material.youngs_modulus, pair.wheel.material.poissons_ratio) == pytest.approx(
        (3e9, 0.4)
    )


def test_a_shaft_arrives_in_si_on_the_side_of_its_gear():
    shaft = {"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": -20.0}
    on_wheel = {"pair.wheel.shaft": shaft | {"bearing_stiffness_n_per_um": 400.0}}
    first, second = gear_pair(changed_case(on_wheel)).shafts
    assert first is None and second is not None
    assert (second.length, second.diameter, second.position) == pytest.approx((0.2, 0.04, -0.02), rel=1e-12)
    assert second.bearing_stiffness == pytest.approx(4e8, rel=1e-12)
    with assert_refused("pair.wheel.shaft.position_mm") as faults:
        gear_pair(changed_case({"pair.wheel.shaft": shaft | {"position_mm": 401.0}}))
    assert (faults[0].value, faults[0].bound) == (401.0, "from -200 to 400")
    inside = {"pair.wheel.shaft": shaft | {"position_mm": 100.0}, "accuracy.model": "plane_strain"}
    with assert_refused("pair.wheel.shaft"):
        check_case(changed_case(inside))


def test_arguments_of_the_analysis_are_si():
    errors = {"misalignment_um": [0.0, 30.0], "center_distance_change_mm": [-0.1, 0.0]}
    accuracy = {"time_budget_s": 3.0, "positions": 64, "model": "plane_stress"}
    stated = changed_case({"errors": errors, "accuracy": accuracy})
    axes, options = table_axes(stated), analysis_options(stated)
    assert axes.torques == (10.0, 100.0) and axes.normal_forces is None
    assert axes.misalignments == pytest.approx((0.0, 3e-5))
    assert axes.center_distance_changes == pytest.approx((-1e-4, 0.0))
    assert (options.tolerance, options.time_budget, options.positions) == (None, 3.0, 64)


def test_the_floor_of_a_tolerance_is_given_in_nm():
    def allowed(**accuracy):
        return analysis_options(validated(Case, GOOD | {"accuracy": accuracy})).tolerance

    assert allowed() == AllowedError(0.01, 20e-9)
    assert allowed(tolerance=0.02, tolerance_floor_nm=0.0) == AllowedError(0.02, 0.0)
    assert allowed(tolerance_floor_nm=50.0).floor == pytest.approx(5e-8)
    with assert_refused("accuracy.tolerance"):
        allowed(tolerance=1e-6)


def test_the_echo_holds_every_default_and_is_its_own_fixed_point():
    echo = case_json(case())
    assert echo["accuracy"]["tolerance"] == 0.01
    assert echo["accuracy"]["tolerance_floor_nm"] == 20.0
    assert echo["pair"]["pinion"]["addendum_coefficient"] == 1.0
    assert case_json(validated(Case, echo)) == echo
    assert json.loads(json.dumps(echo, allow_nan=False)) == echo


def test_the_key_depends_on_what_decides_the_result_and_on_nothing_else():
    loads = {"torque_n_m": [10, 100]}
    written_out = GOOD | {"effects": {}, "errors": {"misalignment_um": [0]}, "load": loads}
    keys = [content_key("analyze", "1", case_json(validated(Case, table))) for table in (GOOD, written_out)]
    assert keys[0] == keys[1]
    assert content_key("analyze", "2", case_json(case())) != keys[0]
    assert content_key("analyze", "1", case_json(case(bore_diameter_mm=40.001))) != keys[0]


def test_a_change_of_center_distance_at_which_the_gears_do_not_mesh_is_refused_by_its_place():
    good, wrong = (changed_case({"errors.center_distance_change_mm": [0.0, far]}) for far in (0.1, 8.0))
    assert check_case(good).center_distance == pytest.approx(0.08)
    with assert_refused("errors.center_distance_change_mm[1]") as faults:
        check_case(wrong)
    assert faults[0].value == 8.0
    bound = faults[0].bound
    assert bound.startswith("a change at which the gears mesh") and bound.endswith("below 1")


def test_pitch_deviations_arrive_in_si_and_pitches_as_they_are():
    deviations = [0.5 * tooth for tooth in range(20)]
    found = case(pitch_deviation_um=deviations)
    pair = gear_pair(found)
    assert pair.pinion.pitch_deviation.cumulative == pytest.approx([1e-6 * d for d in deviations], rel=1e-15)
    assert pair.wheel.pitch_deviation.neutral
    assert table_axes(changed_case({"accuracy.pitches": 40})).pitches == 40
    assert table_axes(case()).pitches is None


@pytest.mark.parametrize(
    ("pinion", "accuracy", "field", "words"),
    [
        ({"pitch_deviation_um": [1.0] * 19}, {}, "pair.pinion.pitch_deviation_um", "a list of 20 values"),
        ({"pitch_deviation_um": [5000.0] * 20}, {}, "pair.pinion.pitch_deviation_um[0]", "1000"),
        ({"teeth": 21}, {"pitches": 21}, "accuracy.pitches", "left out where all teeth are alike"),
        (
            {"teeth": 21, "pitch_deviation_um": [0.0, 1.0] + [0.0] * 19},
            {"pitches": 3000},
            "accuracy.pitches",
            "at most 2343",
        ),
    ],
)
def test_bad_pitch_errors_are_refused_by_the_name_of_the_case(pinion, accuracy, field, words):
    distance = {"pair.center_distance_mm": 80.0 + 2.0 * (pinion.get("teeth", 20) - 20)}
    own = {f"pair.pinion.{name}": value for name, value in pinion.items()}
    with assert_refused(field, words):
        check_case(changed_case(own | distance | {"accuracy": accuracy}))


def test_a_modulus_below_that_of_rubber_is_refused():
    with pytest.raises(BadInput, match=r"youngs_modulus_gpa = 5e-324: must be from 0\.001 to 2000"):
        validated(Case, CASE | {"material": {"youngs_modulus_gpa": 5e-324}})
    assert validated(Case, CASE | {"material": {"youngs_modulus_gpa": 0.001}})


INLINE = {"roll_length_mm": [4.0, 19.0], "face_position_mm": [-5.0, 5.0], "removed_um": [[0, 0], [1, 2]]}
TOO_FINE = {
    "roll_length_mm": [0.01 * k for k in range(500)],
    "face_position_mm": [0.01 * k for k in range(300)],
    "removed_um": [[0.0, 0.0]] * 2,
}
HEADING = "roll_length_mm,face_position_mm,removed_um"
ROWS = [f"{roll},{face},{roll * face / 10}" for roll in (4.5, 10, 19) for face in (-12.5, 0, 12.5)]
CASE_WITH_GRID = (
    spur_case('flank_grid_csv = "flanks/pinion.csv"')
    + """
[load]
torque_n_m = [100.0]
"""
)


def written(folder: Path, *lines: str) -> Path:
    """Write a case file and its CSV file; return the case file."""
    (folder / "flanks").mkdir()
    (folder / "flanks" / "pinion.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    file = folder / "case.toml"
    file.write_text(CASE_WITH_GRID, encoding="utf-8")
    return file


def test_a_file_is_read_beside_the_case_whatever_the_order_of_its_rows(tmp_path):
    shuffled = random.Random(3).sample(ROWS, len(ROWS))
    case = read_model(Case, written(tmp_path, "\ufeff# measured", HEADING, "", *shuffled))
    grid = gear_pair(case).pinion.modification.flank_grid
    assert grid.roll_length == pytest.approx((4.5e-3, 10e-3, 19e-3), rel=1e-12, abs=0.0)
    assert grid.face_position == pytest.approx((-12.5e-3, 0.0, 12.5e-3), rel=1e-12, abs=1e-18)
    assert grid.removed[2] == pytest.approx((-23.75e-6, 0.0, 23.75e-6), rel=1e-12, abs=1e-18)
    assert gear_pair(case).wheel.modification.flank_grid is None


def test_columns_may_fake_any_order(tmp_path):
    turned = [",".join(line.split(",")[::-1]) for line in (HEADING, *ROWS)]
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    cases = [
        read_model(Case, written(tmp_path / name, *lines))
        for name, lines in (("a", (HEADING, *ROWS)), ("b", turned))
    ]
    assert cases[0] == cases[1]


def test_the_echo_holds_the_grid_itself_and_needs_no_file(tmp_path):
    case = read_model(Case, written(tmp_path, HEADING, *ROWS))
    echo = case_json(case)
    assert "flank_grid_csv" not in echo["pair"]["pinion"]
    assert echo["pair"]["pinion"]["flank_grid"]["roll_length_mm"] == [4.5, 10.0, 19.0]
    assert case_json(validated(Case, echo)) == echo


def test_a_grid_of_a_case_inside_a_scene_is_found(tmp_path):
    written(tmp_path, HEADING, *ROWS)
    nested = CASE_WITH_GRID.replace("[pair", "[meshes.case.pair").replace("[load]", "[meshes.case.load]")
    (tmp_path / "scene.toml").write_text('[[meshes]]\nname = "m"\n' + nested, encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        read_model(SceneInput, tmp_path / "scene.toml")
    assert not [fault for fault in caught.value.faults if "case" in fault.field]
    (tmp_path / "flanks" / "pinion.csv").unlink()
    with pytest.raises(BadInput) as caught:
        read_model(SceneInput, tmp_path / "scene.toml")
    assert caught.value.faults[0].field == "meshes[0].case.pair.pinion.flank_grid_csv.file"


def test_a_client_cannot_name_a_file():
    with assert_refused("pair.pinion.flank_grid_csv") as faults:
        validated(Case, changed(GOOD, {"pair.pinion.flank_grid_csv": "/etc/passwd"}))
    assert faults[0].bound.startswith("left out")


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "it is empty"),
        ([HEADING.replace("_um", "_mm"), *ROWS], HEADING),
        ([HEADING.replace(",", ";"), *ROWS], "with commas"),
        (
            [HEADING, *ROWS[:-1]],
            "1 of 9 nodes are missing, the first at roll_length_mm = 19, face_position_mm",
        ),
        ([HEADING, *(f"{n},{n},1" for n in range(20_000))], "399980000 of 400000000 nodes are missing"),
        ([HEADING, *ROWS, ROWS[0]], "line 11 repeats"),
        ([HEADING, *ROWS[:-1], "19,12.5,"], "line 10 holds nothing in removed_um"),
        ([HEADING, *ROWS[:-1], "19,nan,1"], "line 10 holds 'nan' in face_position_mm"),
        ([HEADING, *ROWS[:-1], "19,12.5"], "line 10 has 2"),
    ],
)
def test_a_file_that_holds_no_grid_is_refused_by_what_is_wrong(tmp_path, lines, said):
    with assert_refused("pair.pinion.flank_grid_csv", said):
        read_model(Case, written(tmp_path, *lines))


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"roll_length_mm": [19.0, 4.0]}, "roll_length_mm"),
        ({"removed_um": [[0.0, 0.0], [1.0]]}, "removed_um[1]"),
        ({"removed_um": [[0.0, 0.0], [1.0, 2000.0]]}, "removed_um[1][1]"),
        ({"removed_um": [[0.0, 0.0], [1.0, float("nan")]]}, "removed_um[1][1]"),
        ({"face_position_mm": [20.0, 30.0]}, "face_position_mm"),
        ({"face_position_mm": [0.0]}, "face_position_mm"),
    ],
)
def test_an_inline_grid_is_refused_by_the_cases_names(change, field):
    with pytest.raises(BadInput) as caught:
        check_case(validated(Case, changed(GOOD, {"pair.pinion.flank_grid": INLINE | change})))
    assert caught.value.faults[0].field.startswith(f"pair.pinion.flank_grid.{field}")


def test_a_grid_that_differs_over_the_face_is_no_matter_of_the_plane():
    plane = GOOD | {"accuracy": {"model": "plane_strain"}}
    even = INLINE | {"removed_um": [[0, 0], [2, 2]]}
    check_case(validated(Case, changed(plane, {"pair.pinion.flank_grid": even})))
    with assert_refused("pair.pinion.flank_grid.removed_um"):
        check_case(validated(Case, changed(plane, {"pair.pinion.flank_grid": INLINE})))


def test_run_out_and_waves_arrive_in_si():
    wave = {"order": 11, "amplitude_um": 0.2, "phase_deg": 90.0, "face_waves": 2.0}
    pair = gear_pair(case(run_out={"eccentricity_um": 5.0, "wobble_angle_deg": 30.0}, waves=[wave]))
    assert pair.pinion.run_out.eccentricity == pytest.approx(5e-6, rel=1e-15)
    assert pair.pinion.run_out.wobble_angle == pytest.approx(math.radians(30.0), rel=1e-15)
    (found,) = pair.pinion.waves
    assert (found.order, found.face_waves) == (11, 2.0)
    assert (found.amplitude, found.phase) == pytest.approx((2e-7, 0.5 * math.pi), rel=1e-15)
    assert pair.wheel.run_out.neutral and pair.wheel.waves == ()


def test_flanks_of_teeth_arrive_in_si():
    flank = {"tooth": 3, "profile_slope_um": 2.0, "helix_form_um": -1.0, "helix_form_waves": 4}
    teeth = {
        "tooth_flanks": [flank | {"flank_grid": INLINE}],
        "single_pitch_deviation_um": [1.0, *19 * [0.0]],
    }
    pinion = gear_pair(case(**teeth)).pinion
    (found,) = pinion.tooth_flanks
    assert (found.tooth, found.helix_form_waves) == (3, 4)
    assert (found.profile_slope, found.helix_form) == pytest.approx((2e-6, -1e-6), rel=1e-15)
    assert found.flank_grid.removed[1] == pytest.approx((1e-6, 2e-6), rel=1e-15)
    assert pinion.pitch_deviation.individual[:2] == pytest.approx((0.95e-6, -0.05e-6), rel=1e-12)


@pytest.mark.parametrize(
    ("gear", "field"),
    [
        ({"waves": [{"order": 11, "amplitude_um": 2000.0}]}, "pair.pinion.waves[0].amplitude_um"),
        ({"waves": [{"order": -1, "amplitude_um": 0.2}]}, "pair.pinion.waves[0].order"),
        ({"waves": [{"order": 0, "amplitude_um": 0.2}]}, "pair.pinion.waves[0].order"),
        ({"waves": [{"amplitude_um": 0.2}]}, "pair.pinion.waves[0].order"),
        ({"waves": [{"order": 1, "amplitude_um": float("nan")}]}, "pair.pinion.waves[0].amplitude_um"),
        ({"waves": [{"order": 1, "amplitude_um": 0.2}] * 101}, "pair.pinion.waves"),
        ({"run_out": {"eccentricity_um": -1.0}}, "pair.pinion.run_out.eccentricity_um"),
        ({"tooth_flanks": [{"tooth": 21}]}, "pair.pinion.tooth_flanks[0].tooth"),
        ({"tooth_flanks": [{"tooth": 0}]}, "pair.pinion.tooth_flanks[0].tooth"),
        (
            {"tooth_flanks": [{"tooth": 1, "helix_slope_um": 2000.0}]},
            "pair.pinion.tooth_flanks[0].helix_slope_um",
        ),
        (
            {"tooth_flanks": [{"tooth": 1, "flank_grid": INLINE | {"removed_um": [[0, 0], [1]]}}]},
            "pair.pinion.tooth_flanks[0].flank_grid.removed_um[1]",
        ),
        (
            {"tooth_flanks": [{"tooth": k, "flank_grid": TOO_FINE} for k in (1, 2)]},
            "pair.pinion.tooth_flanks",
        ),
        ({"single_pitch_deviation_um": [1.0] * 19}, "pair.pinion.single_pitch_deviation_um"),
        (
            {"single_pitch_deviation_um": [1.0] * 20, "pitch_deviation_um": [1.0] * 20},
            "pair.pinion.single_pitch_deviation_um",
        ),
    ],
)
def test_bad_waves_are_refused_by_the_name_of_the_case(gear, field):
    with assert_refused(field, ""):
        gear_pair(case(**gear))
