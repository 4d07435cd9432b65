"""Starts of reliefs as on a drawing: diameter, roll length and roll angle name one point of the flank."""

import json
import math
from typing import Any

import numpy as np
import pytest
from bad_inputs import GOOD
from changed_scenes import changed

from fe_contact.flank.drawing_starts import DrawingStarts
from fe_contact.geometry import Gear, ParallelAxes
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.gear import has_extent, with_figures
from lineofaction.gearbox.schemas.toml import toml_text

HELICAL: dict[str, Any] = {"pair.helix_angle_deg": 20.0, "pair.center_distance_mm": 85.4}
RING: dict[str, Any] = {
    "pair.center_distance_mm": 79.8,
    "pair.wheel": {
        "teeth": 60,
        "face_width_mm": 25.0,
        "internal": True,
        "rim_diameter_mm": 280.0,
        "addendum_coefficient": 0.75,
    },
}
PAIRS = {"spur": {}, "helical": HELICAL, "ring gear": RING}
RELIEFS = {"tip_relief": 0.7, "root_relief": 0.3}
"""Where they start, in parts of the way from form to tip point."""
DIAMETER, ROLL_LENGTH, ROLL_ANGLE = "start_diameter_mm", "start_roll_length_mm", "start_roll_angle_deg"


def case(pair: dict[str, Any], gear: str = "pinion", **facts: Any) -> Case:
    own = {f"pair.{gear}.{name}": value for name, value in facts.items()}
    return validated(Case, changed(changed(GOOD, pair), own))


def ways(gear: Any, share: float) -> dict[str, float]:
    """Return the point at a share of the roll length in each way, by ISO 21771-1 from the pressure angle."""
    roll = gear.form_roll_length + share * (gear.tip_roll_length - gear.form_roll_length)
    pressure = math.atan2(roll, gear.base_radius)
    return {
        DIAMETER: 2e3 * gear.base_radius / math.cos(pressure),
        ROLL_LENGTH: 1e3 * gear.base_radius * math.tan(pressure),
        ROLL_ANGLE: math.degrees(math.tan(pressure)),
    }


def removed(pair: ParallelAxes, gear: str) -> np.ndarray:
    own = getattr(pair, gear)
    roll = np.linspace(own.form_roll_length, own.tip_roll_length, 401)
    return np.asarray(own.modification.material_removed(own, roll))


@pytest.mark.parametrize("relief", RELIEFS)
@pytest.mark.parametrize(("pair", "gear"), [("spur", "pinion"), ("helical", "wheel"), ("ring gear", "wheel")])
def test_three_ways_name_one_flank(pair, gear, relief):
    plain = getattr(gear_pair(case(PAIRS[pair])), gear)
    start = RELIEFS[relief]
    points = ways(plain, start)
    end = plain.tip_radius if relief == "tip_relief" else plain.form_radius
    length = {"length_mm": abs(2e3 * end - points[DIAMETER]) / 2.0}
    flanks = [
        removed(gear_pair(case(PAIRS[pair], gear, **{f"{relief}_um": 20.0, f"{relief}_{way}": value})), gear)
        for way, value in (points | length).items()
    ]
    assert np.abs(flanks[0]).max() == pytest.approx(20e-6, rel=1e-12)
    for flank in flanks[1:]:
        assert np.abs(flank - flanks[0]).max() <= 1e-12 * 20e-6
    # it starts there: nothing is removed before, something after
    share = np.linspace(0.0, 1.0, 401)
    outwards = share - start if relief == "tip_relief" else start - share
    assert (flanks[0][outwards < -1e-9] == 0.0).all() and (flanks[0][outwards > 1e-9] > 0.0).all()


def test_it_is_the_roll_angle_of_the_tabled_involute():
    """At alpha_y = 28 deg: inv 0.043017 in the tables, xi = inv + alpha_y, d_y = d_b/cos(28 deg)."""
    roll_angle = math.radians(28.0) + 0.043017
    base = 4.0 * 20 * 0.9396926  # d_b in mm, cos 20 deg
    gear = Gear(normal_module=4e-3, teeth=20, face_width=25e-3, bore_diameter=40e-3)
    facts = {
        "tip_relief_start_diameter": 1e-3 * base / 0.8829476,
        "tip_relief_start_roll_length": 1e-3 * 0.5 * base * roll_angle,
        "tip_relief_start_roll_angle": roll_angle,
    }
    for name, value in facts.items():
        lengths = DrawingStarts(**{name: value}).lengths({}, lambda: gear)
        assert lengths == {"tip_relief_length": pytest.approx(0.5 * (88e-3 - 85.14142e-3), abs=3e-8)}


@pytest.mark.parametrize("way", [DIAMETER, ROLL_LENGTH, ROLL_ANGLE])
@pytest.mark.parametrize("suffix", ["toml", "json"])
def test_a_file_keeps_what_was_typed(way, suffix, tmp_path):
    typed = {DIAMETER: 85.3, ROLL_LENGTH: 20.1, ROLL_ANGLE: 30.7}[way]
    content = case_json(case({}, tip_relief_um=20.0, **{f"tip_relief_{way}": typed}))
    file = tmp_path / f"case.{suffix}"
    file.write_text(toml_text(content) if suffix == "toml" else json.dumps(content))
    again = case_json(read_model(Case, file))
    assert again == content
    gear = again["pair"]["pinion"]
    assert gear[f"tip_relief_{way}"] == typed and gear["tip_relief_length_mm"] == 0.0
    assert [name for name in gear if "_start_" in name] == [f"tip_relief_{way}"]


def test_results_of_cases_without_a_start_keep_their_addresses():
    assert not [name for name in case_json(case({}))["pair"]["pinion"] if "_start_" in name]


TIP, ROOT = "tip_relief_", "root_relief_"


@pytest.mark.parametrize(
    ("facts", "field", "bound"),
    [
        (
            {TIP + DIAMETER: 89.0},
            TIP + DIAMETER,
            "from the form diameter 75.28027 to below the tip diameter 88",
        ),
        (
            {TIP + DIAMETER: 88.0},
            TIP + DIAMETER,
            "from the form diameter 75.28027 to below the tip diameter 88",
        ),
        ({TIP + ROLL_LENGTH: 1.9}, TIP + ROLL_LENGTH, "from the form roll length 1.985967 to below the tip"),
        ({TIP + ROLL_ANGLE: 35.0}, TIP + ROLL_ANGLE, "to below the tip roll angle 34.8655"),
        (
            {ROOT + ROLL_ANGLE: 3.0},
            ROOT + ROLL_ANGLE,
            "above the form roll angle 3.027254 and at most the tip",
        ),
        ({ROOT + DIAMETER: 88.1}, ROOT + DIAMETER, "above the form diameter 75.28027 and at most the tip"),
        (
            {TIP + DIAMETER: 85.0, TIP + "length_mm": 1.5},
            TIP + DIAMETER,
            "left out beside tip_relief_length_mm",
        ),
        (
            {TIP + DIAMETER: 85.0, TIP + ROLL_ANGLE: 31.0},
            TIP + ROLL_ANGLE,
            "left out beside tip_relief_start_diameter_mm",
        ),
        (
            {},
            TIP + "length_mm",
            "above 0, or left out beside one of tip_relief_start_diameter_mm, tip_relief",
        ),
        ({TIP + DIAMETER: -85.0}, TIP + DIAMETER, "from 0 to 20000"),
        ({TIP + DIAMETER: math.nan}, TIP + DIAMETER, "a finite number"),
    ],
)
def test_refusals_name_field_value_bound_and_advice(facts, field, bound):
    depth = {"root_relief_um": 10.0} if any(ROOT in name for name in facts) else {"tip_relief_um": 20.0}
    with pytest.raises(BadInput) as refusal:
        gear_pair(case({}, **depth | facts))
    (fault,) = refusal.value.faults
    assert fault.field == f"pair.pinion.{field}" and fault.suggestion
    assert bound in fault.bound
    value = facts.get(field, 0.0)
    assert fault.value == value or (math.isnan(value) and fault.value is not None)


def test_of_a_ring_gear_the_tip_diameter_is_the_smaller():
    with pytest.raises(BadInput, match="above the tip diameter 234 and at most the form diameter 24"):
        gear_pair(case(RING, "wheel", tip_relief_um=20.0, tip_relief_start_diameter_mm=230.0))


def test_a_length_of_a_search_or_a_slider_replaces_the_start():
    plain = case({}, tip_relief_um=20.0, tip_relief_start_diameter_mm=85.0)
    gear = case_json(plain)["pair"]["pinion"] | {"root_relief_start_roll_angle_deg": 10.0}
    assert with_figures(gear, {"tip_relief_um": 8.0}) == gear | {"tip_relief_um": 8.0}
    longer = with_figures(gear, {"tip_relief_length_mm": 2.0})
    assert [name for name in longer if "_start_" in name] == ["root_relief_start_roll_angle_deg"]
    assert longer["tip_relief_length_mm"] == 2.0
    assert has_extent(plain.pair.pinion, "tip_relief") and not has_extent(plain.pair.wheel, "tip_relief")
