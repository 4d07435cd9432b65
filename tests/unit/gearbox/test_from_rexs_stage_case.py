"""Cases of the cylindrical stages of a REXS model: macro geometry, driver and load levels."""

import math
from typing import Any

import pytest
from opened_unit import said
from rexs_stage import (
    GEARS,
    PINION,
    PINION_LEFT,
    PINION_RIGHT,
    STAGE,
    WHEEL,
    WHEEL_LEFT,
    WHEEL_RIGHT,
    Values,
    relation,
    stage_unit,
)

from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.stage_case import StageCase


def only(unit: GearUnit, **options: Any) -> StageCase:
    (case,) = StageCase.all_of(unit, **{"torques": {}, **options})
    return case


SHIFTED: Values = {
    STAGE: {"center_distance": 80.9},
    **{flank: {"addendum_modification_coefficient": 0.3} for flank in (PINION_LEFT, PINION_RIGHT)},
    **{flank: {"addendum_modification_coefficient": None} for flank in (WHEEL_LEFT, WHEEL_RIGHT)},
}


def test_the_macro_geometry_is_that_of_the_file():
    unit = stage_unit({PINION: {"tip_diameter": 44.2, "root_diameter": 35.2, "inner_diameter": 15.0}})
    stage = only(unit)
    pair = stage.case.pair
    assert (pair.normal_module_mm, pair.normal_pressure_angle_deg, pair.center_distance_mm) == (2.0, 20.0, 80)
    assert (pair.pinion.teeth, pair.wheel.teeth) == (20, 60)
    assert pair.pinion.tip_diameter_mm == 44.2
    assert pair.pinion.bore_diameter_mm == 15.0
    assert gear_pair(stage.case).pinion.root_radius == pytest.approx(17.6e-3, rel=1e-12)
    assert (stage.driver, stage.driven, stage.wheel_drives) == (PINION, WHEEL, False)
    assert stage.center_distance == pytest.approx(0.08, rel=1e-15)


def test_a_missing_shift_follows_from_the_center_distance_and_the_mate():
    # x_1 + x_2 = (z_1 + z_2) (inv alpha_wt - inv alpha_t) / (2 tan alpha_n), a = 80.9 mm
    working = math.acos(80.0 * math.cos(math.radians(20.0)) / 80.9)
    involutes = [math.tan(angle) - angle for angle in (working, math.radians(20.0))]
    total = 80 * (involutes[0] - involutes[1]) / (2.0 * math.tan(math.radians(20.0)))
    unit = stage_unit(SHIFTED)
    case = only(unit).case
    assert case.pair.wheel.profile_shift_coefficient == pytest.approx(total - 0.3, rel=1e-9)
    assert gear_pair(case).transverse_base_backlash == pytest.approx(0.0, abs=1e-12)
    assert said(unit, WHEEL, "addendum_modification_coefficient")[0] == "derived"


def test_without_any_shift_there_is_no_case_and_the_account_says_why():
    both = (PINION_LEFT, PINION_RIGHT, WHEEL_LEFT, WHEEL_RIGHT)
    unit = stage_unit({flank: {"addendum_modification_coefficient": None} for flank in both})
    assert StageCase.all_of(unit, {}) == ()
    fate, words = said(unit, STAGE, "")
    assert fate == "refused"
    assert "addendum_modification_coefficient" in words


def test_a_tip_of_one_millimeter_is_none():
    unit = stage_unit({PINION: {"tip_diameter": 1.0}})
    assert only(unit).case.pair.pinion.tip_diameter_mm == pytest.approx(44.0, rel=1e-12)
    fate, words = said(unit, PINION, "tip_diameter")
    assert fate == "defaulted"
    assert words.startswith("1 mm is no tip diameter")


def test_both_tips_are_cut_by_what_the_shifts_bring_the_gears_closer():
    pair = gear_pair(only(stage_unit(SHIFTED)).case)
    # With k = (a - a_d)/m_n - (x_1 + x_2) both clearances are that of the basic rack, 0.25 m_n.
    assert pair.tip_clearances == pytest.approx((0.5e-3, 0.5e-3), rel=1e-9)


def test_the_mean_deviation_of_the_span_is_the_allowance_and_the_backlash():
    span = "{}_backlash_allowance_referenced_to_span"
    unit = stage_unit({PINION: {span.format("upper"): -20.0, span.format("lower"): -60.0}})
    pair = gear_pair(only(unit).case)
    # The span is measured along the normal: 40 um of it are 40 um of backlash of a spur pair.
    assert pair.normal_backlash == pytest.approx(40e-6, rel=1e-6)
    assert said(unit, PINION, span.format("upper"))[0] == "derived"
    thick = stage_unit({PINION: {span.format("upper"): 60.0, span.format("lower"): 20.0}})
    assert only(thick).case.pair.pinion.thickness_allowance_um == 0.0
    assert said(thick, PINION, span.format("upper"))[0] == "refused"


def test_the_tool_makes_the_root():
    tool = {"addendum_coefficient_reference_profile": 1.4, "tip_corner_radius_factor_reference_profile": 0.3}
    unit = stage_unit(
        {40: tool},
        {40: "rack_shaped_tool"},
        [relation(110, "manufacturing_step", 1, workpiece=PINION_RIGHT, tool=40)],
    )
    pinion = only(unit).case.pair.pinion
    assert (pinion.dedendum_coefficient, pinion.root_radius_coefficient) == (1.4, 0.3)
    assert said(unit, 40, "addendum_coefficient_reference_profile")[0] == "taken"


SPAN = {f"{side}_backlash_allowance_referenced_to_span": -100.0 for side in ("upper", "lower")}
INFEED = 0.5 * 100e-6 / math.cos(math.radians(20.0)) / math.tan(math.radians(20.0))
"""m; the cutter of teeth thinned by 100 um of their span stands deeper by it."""


def with_root(diameter: float | None, addendum: float | None) -> GearUnit:
    """Return a unit whose pinion, d 40 mm, has 100 um less span, a root diameter in mm and a tool."""
    return stage_unit(
        {
            PINION: SPAN | {"root_diameter": diameter},
            40: {"addendum_coefficient_reference_profile": addendum},
        },
        {40: "rack_shaped_tool"},
        [relation(110, "manufacturing_step", 1, workpiece=PINION_RIGHT, tool=40)],
    )


def test_the_tool_stands_deeper_for_the_deviation_of_the_span():
    pinion = gear_pair(only(with_root(None, 1.4)).case).pinion
    assert pinion.tooth_thinning == "generating"
    assert pinion.dedendum_coefficient == 1.4
    assert pinion.root_radius == pytest.approx(20e-3 - 1.4 * 2e-3 - INFEED, rel=1e-12)


@pytest.mark.parametrize("addendum", [None, 1.4])
def test_a_stated_root_diameter_is_that_of_the_thinned_teeth(addendum):
    """It wins over the tool, whatever the allowance, as far as the tool does not say that it was not cut."""
    unit = with_root(34.6, addendum)
    pinion = gear_pair(only(unit).case).pinion
    assert pinion.root_radius == pytest.approx(17.3e-3, rel=1e-12)
    assert pinion.tooth_thinning == "generating"
    assert pinion.dedendum_coefficient == pytest.approx(1.35 - INFEED / 2e-3, rel=1e-9)
    assert "x - A_s / (2 m_n tan alpha_n)" in said(unit, PINION, "root_diameter")[1]


def test_a_root_that_the_tool_reaches_without_the_allowance_says_that_the_flanks_are_ground():
    unit = with_root(34.4, 1.4)
    pinion = gear_pair(only(unit).case).pinion
    assert pinion.tooth_thinning == "flank"
    assert pinion.root_radius == pytest.approx(17.2e-3, rel=1e-12)
    assert pinion.dedendum_coefficient == pytest.approx(1.4, rel=1e-12)
    assert "tooth_thinning flank" in said(unit, PINION, "root_diameter")[1]
    deeper = only(with_root(round(34.4 - 2e3 * INFEED, 3), 1.4)).case.pair.pinion
    assert deeper.tooth_thinning == "generating"
    assert deeper.dedendum_coefficient == pytest.approx(1.4, abs=2e-4)


@pytest.mark.parametrize("hand", [1, -1])
def test_the_helix_hand_is_that_of_the_driving_gear(hand):
    changes: dict[int, dict[str, Any]] = {
        PINION: {"helix_angle_reference_diameter": hand * 15.0},
        WHEEL: {"helix_angle_reference_diameter": -hand * 15.0},
        STAGE: {"center_distance": 80.0 / math.cos(math.radians(15.0))},
    }
    assert only(stage_unit(changes)).case.pair.helix_angle_deg == hand * 15.0
    turned = only(stage_unit(changes), drivers={STAGE: WHEEL})
    assert turned.case.pair.helix_angle_deg == -hand * 15.0
    assert (turned.driver, turned.case.pair.pinion.teeth) == (WHEEL, 60)


def test_external_gears_of_one_hand_do_not_mate():
    helix = {"helix_angle_reference_diameter": 15.0}
    unit = stage_unit({PINION: helix, WHEEL: helix})
    assert StageCase.all_of(unit, {}) == ()
    words = said(unit, STAGE, "")[1]
    assert "of opposite hands" in words and "right hand, 15 deg" in words


def ring_unit(sign: int = 1) -> GearUnit:
    """Return a planet of 20 teeth in a ring gear of 60, its teeth counted by a writer's sign."""
    changes: dict[int, dict[str, Any]] = {
        WHEEL: {
            "number_of_teeth": sign * 60,
            "tip_diameter": sign * 117.0,
            "support_vector": (30.0, 0.0, -40.0),
        },
        STAGE: {"center_distance": sign * 40.0},
    }
    return stage_unit(changes, {WHEEL: "ring_gear"})


@pytest.mark.parametrize("sign", [1, -1])
def test_a_ring_gear_is_the_wheel_whatever_the_sign_of_its_teeth(sign):
    stage = only(ring_unit(sign))
    assert stage.case.pair.wheel.internal
    assert stage.case.pair.wheel.teeth == 60
    assert stage.case.pair.center_distance_mm == 40.0


def test_a_driving_ring_gear_stays_the_wheel_and_its_torque_is_counted_on_the_pinion():
    stage = only(ring_unit(), drivers={STAGE: WHEEL}, torques={STAGE: (90.0, 30.0)})
    assert stage.wheel_drives
    assert (stage.driver, stage.driven) == (WHEEL, PINION)
    assert stage.case.load.torque_n_m == (10.0, 30.0)


def test_torques_are_load_levels_and_their_sign_is_no_load():
    stage = only(stage_unit(), torques={STAGE: (-50.0, -20.0, -50.0)})
    assert stage.case.load.torque_n_m == (20.0, 50.0)


def test_without_torques_the_load_levels_are_stated():
    unit = stage_unit()
    # F_t / (b m_n) = 5, 15, 30 N/mm^2 on b = 20, m_n = 2, d = 40 mm: T = 4, 12, 24 N m
    assert only(unit).case.load.torque_n_m == (4.0, 12.0, 24.0)
    assert said(unit, STAGE, "torque")[0] == "defaulted"


def test_a_value_out_of_bounds_leaves_the_other_stages():
    unit = stage_unit(
        {PINION: {"face_width": 60e3}, 13: GEARS[PINION], 14: GEARS[WHEEL], 21: GEARS[STAGE]}
        | {35: GEARS[PINION_LEFT], 36: GEARS[WHEEL_LEFT]},
        {13: "cylindrical_gear", 14: "cylindrical_gear", 21: "cylindrical_stage"}
        | {35: "cylindrical_gear_flank", 36: "cylindrical_gear_flank"},
        [
            relation(111, "stage", stage=21, gear_1=13, gear_2=14),
            relation(112, "flank", gear=13, left=35, right=35),
            relation(113, "flank", gear=14, left=36, right=36),
        ],
    )
    assert only(unit).stage == 21
    fate, words = said(unit, STAGE, "")
    assert fate == "refused"
    assert "pair.pinion.face_width_mm" in words
    assert "50000" in words


def test_other_stages_are_refused():
    unit = stage_unit(types={22: "bevel_stage"})
    only(unit)
    assert said(unit, 22, "")[0] == "refused"
