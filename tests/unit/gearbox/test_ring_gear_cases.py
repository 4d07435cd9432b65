"""Cases: a ring gear as wheel, modifications over a part of the flank, and the light check of loads alone."""

import copy
import math
import tomllib
from pathlib import Path
from typing import Any

import pytest

from bounds import Kind, PlausibilityWarning
from fe_contact import FlankModification, InternalGearPair, Material, RingGear, analyze
from fe_contact.compliance.rounding import LARGEST_ROUNDING, disc_rounding
from lineofaction.gearbox.convert.case import THICK, case_json, gear_pair
from lineofaction.gearbox.convert.checked_case import check_case, check_plain_case
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.report.pair import iso_mesh_stiffness, pair_of

EXAMPLE = Path(__file__).parents[3] / "examples" / "internal_gear.toml"
TABLE = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))


def case(pair: dict[str, Any] | None = None, **wheel: Any) -> Case:
    """Return the example with changes; None leaves a field of the wheel out."""
    table = copy.deepcopy(TABLE)
    table["pair"] |= pair or {}
    changed = table["pair"]["wheel"] | wheel
    table["pair"]["wheel"] = {name: value for name, value in changed.items() if value is not None}
    return validated(Case, table)


def ring_of(given: Case) -> RingGear:
    pair = gear_pair(given)
    assert isinstance(pair, InternalGearPair)
    return pair.wheel


def test_the_example_is_a_planet_in_its_ring():
    pair = check_case(read_model(Case, EXAMPLE))
    assert isinstance(pair, InternalGearPair)
    assert (pair.pinion.teeth, pair.wheel.teeth) == (36, 96)
    assert pair.wheel.rim_diameter == pytest.approx(0.212, rel=1e-15)
    assert pair.center_distance == pytest.approx(0.06, rel=1e-15)
    assert (pair.wheel.cutter_teeth, pair.wheel.root_radius_coefficient) == (25, 0.2)


def test_every_field_of_a_ring_gear_reaches_it():
    plain = ring_of(case())
    changes = {
        "rim_diameter_mm": 215.0,
        "cutter_teeth": 30,
        "cutter_profile_shift_coefficient": 0.1,
        "root_radius_coefficient": 0.15,
        "profile_shift_coefficient": 0.02,
        "thickness_allowance_um": 20.0,
        "tooth_thinning": "flank",
        "tip_relief_um": 10.0,
        "tip_rounding_mm": 0.1,
        "tip_chamfer_mm": 0.1,
        "tip_diameter_mm": 188.6,
        "face_width_mm": 21.0,
    }
    for name, value in changes.items():
        more = {"tip_relief_length_mm": 1.0} if name == "tip_relief_um" else {}
        distance = {"center_distance_mm": 59.95}
        assert ring_of(case(distance, **{name: value}, **more)) != plain, name
    assert ring_of(case(cutter_profile_shift_coefficient=0.1)).cutter_profile_shift_coefficient == 0.1


def test_a_ring_has_the_hand_of_its_pinion_and_its_shaft():
    shaft = {"length_mm": 100.0, "diameter_mm": 60.0, "position_mm": 40.0}
    width = {"helix_angle_deg": 10.0, "center_distance_mm": 60.925}
    pair = gear_pair(case(width, rim_diameter_mm=216.0, shaft=shaft))
    assert pair.wheel.helix_angle == pair.pinion.helix_angle > 0.0
    assert pair.shafts[0] is None
    assert pair.shafts[1] is not None


def test_the_echo_says_how_the_ring_is_made_and_is_its_own_fixed_point():
    echo = case_json(case())
    wheel = echo["pair"]["wheel"]
    assert (wheel["cutter_teeth"], wheel["root_radius_coefficient"]) == (25, 0.2)
    assert case_json(validated(Case, echo)) == echo
    assert case_json(case(cutter_teeth=None)) == echo


@pytest.mark.parametrize(
    ("pair", "wheel", "field", "said"),
    [
        ({}, {"rim_diameter_mm": None}, "rim_diameter_mm", "given with internal = true"),
        ({}, {"bore_diameter_mm": 40.0}, "bore_diameter_mm", "left out with internal = true"),
        ({}, {"blank": {"rim_thickness_mm": 5.0, "web_thickness_mm": 5.0}}, "blank", "left out"),
        ({}, {"internal": None}, "bore_diameter_mm", "given"),
        ({}, {"internal": None, "bore_diameter_mm": 40.0}, "rim_diameter_mm", "left out, or given"),
        ({}, {"rim_diameter_mm": 190.0}, "rim_diameter_mm", "above the root diameter 197 mm"),
        ({}, {"addendum_coefficient": 1.0}, "tip_diameter_mm", "at least 188.3211 mm"),
        ({}, {"cutter_teeth": 96}, "cutter_teeth", "from 6 to 95"),
        ({}, {"teeth": 40}, "cutter_teeth", "trimming interference"),
        ({"center_distance_mm": 60.5}, {}, "center_distance_mm", "at most 60 mm, where the teeth jam"),
        ({}, {"teeth": 38, "cutter_teeth": 20, "rim_diameter_mm": 90.0}, "", "interference"),
    ],
)  # fmt: skip
def test_rings_that_cannot_be_are_refused_by_field_in_the_users_units(pair, wheel, field, said):
    with pytest.raises(BadInput) as refusal:
        check_case(case(pair, **wheel))
    (fault, *_) = refusal.value.faults
    assert fault.field.endswith(field)
    assert said in fault.bound


def test_a_table_of_a_ring_gear_is_known_again_by_its_report():
    """From the case that a file gave, and from the request that Python made."""
    given = case()
    pair = gear_pair(given)
    for echo in (case_json(given), None):
        found = analyze(pair, torques=[60.0], level="draft", positions=8, model="plane_strain", case=echo)
        assert found.geometry.internal
        assert pair_of(found) == pair
        assert iso_mesh_stiffness(found) is None


HIGH_SPEED = Path(__file__).parents[3] / "examples" / "wind_turbine_high_speed.toml"
FIELDS = {figure.name: figure.field for figure in figures(FlankModification)}
LENGTH_OF = {
    FIELDS[length.name.removesuffix("_length")]: length.field
    for length in figures(FlankModification, Kind.LENGTH)
}


def taken(case: dict[str, Any]) -> bool:
    try:
        gear_pair(validated(Case, case))
    except BadInput:
        return False
    return True


@pytest.mark.parametrize("amount", LENGTH_OF)
@pytest.mark.parametrize(
    ("given", "whole"),
    [({"amount": 0.0}, True), ({"amount": 5.0}, False), ({"amount": 5.0, "length": 0.5}, True)],
)
def test_an_amount_is_taken_with_its_length(amount, given, whole):
    case = tomllib.loads(HIGH_SPEED.read_text("utf-8"))
    names = {"amount": amount, "length": LENGTH_OF[amount]}
    case["pair"]["pinion"] |= {names[part]: value for part, value in given.items()}
    assert taken(case) == whole


MAX_LAYERS = 36


def plain_case(
    face_width: float = 20.0, helix: float = 20.0, torque: float = 100.0, distance: float = 86.0
) -> Case:
    gear = {"teeth": 20, "face_width_mm": face_width, "bore_diameter_mm": 20.0}
    sizes = {"normal_module_mm": 4.0, "normal_pressure_angle_deg": 20.0, "helix_angle_deg": helix}
    pair: dict[str, Any] = sizes | {"center_distance_mm": distance, "pinion": gear, "wheel": gear}
    return validated(Case, {"pair": pair, "load": {"torque_n_m": [torque]}})


@pytest.mark.parametrize(
    "wrong",
    [
        plain_case(face_width=0.01),
        plain_case(face_width=0.05, helix=30.0, distance=93.0),
        plain_case(distance=200.0),
    ],
    ids=["thin", "thinner than its helix allows", "out of mesh"],
)
@pytest.mark.filterwarnings("ignore::bounds.PlausibilityWarning")
def test_both_refuse_with_one_error(wrong):
    with pytest.raises(BadInput) as whole:
        check_case(wrong)
    with pytest.raises(BadInput) as light:
        check_plain_case(wrong)
    assert str(light.value) == str(whole.value)


def test_both_warn_of_the_same_and_return_the_pair():
    loaded = plain_case(torque=1e5)
    with pytest.warns(PlausibilityWarning) as whole:
        pair = check_case(loaded)
    with pytest.warns(PlausibilityWarning) as light:
        assert check_plain_case(loaded) == pair
    assert [str(each.message) for each in light] == [str(each.message) for each in whole]


@pytest.mark.parametrize("helix", [0.0, 20.0, 50.0])
def test_a_disc_that_is_not_looked_at_is_far_from_the_limit(helix):
    """For every material up to a Poisson's ratio of 0.49."""
    soft = Material(210e9, 0.49)
    left = [disc_rounding(THICK * share, math.radians(helix), MAX_LAYERS, soft) for share in (0.01, 0.1, 1.0)]
    assert max(left) < 0.1 * LARGEST_ROUNDING


@pytest.mark.parametrize("torque", [5e-324, 1e-200, 0.9e-9, 1.1e9])
def test_a_load_is_neither_next_to_nothing_nor_beyond_all_gears(torque):
    """Squared, the smallest are zero: their plan was an unexpected failure."""
    with pytest.raises(BadInput, match=r"load\.torque_n_m"):
        plain_case(torque=torque)
    assert plain_case(torque=1e-9) and plain_case(torque=1e9)


@pytest.mark.parametrize("point", [{"torque_n_m": 1e-152}, {"normal_force_n": 1e-152}])
def test_a_flank_is_looked_at_under_a_load_that_a_case_may_have(point):
    with pytest.raises(BadInput, match="from 1e-09 to 1e"):
        validated(FlankPoint, point)
