"""The pages on REXS files list what the import reads, no more and no less of each component."""

import re
from collections.abc import Iterator
from pathlib import Path

from rexs_stage import PINION, PINION_RIGHT, STAGE, WHEEL, WHEEL_LEFT, WHEEL_RIGHT, relation, stage_unit
from rexs_unit import BALL, ROW, inside, on_lines

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.modifications import READERS, UNREAD
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.schemas.bearings import BallRowInput, RollerRowInput, RollingBearingInput
from lineofaction.gearbox.schemas.driven_gear import WheelInput
from lineofaction.gearbox.schemas.gear import GearInput


def page_of(parts: str) -> str:
    return (Path(__file__).parents[3] / "docs" / "reference" / f"rexs-{parts}.md").read_text("utf-8")


PAGE = page_of("gears")
SECOND = {"tooth_tip_chamfer": 0.2, "addendum_modification_coefficient": None}
UNIT_TOOL = {
    "addendum_coefficient_reference_profile": None,
    "addendum_reference_profile": 2.5,
    "tip_corner_radius_reference_profile": 0.5,
}
MODIFICATIONS: dict[str, dict[str, object]] = {
    "tip_relief": {
        "tip_relief_depth": 0.01,
        "tip_relief_datum_diameter": 42.0,
        "tip_relief_evaluation_reference": 43.0,
        "shape_of_relief": "linear",
        "specify_tangential_transition": False,
    },
    "root_relief": {
        "root_relief_depth": 0.01,
        "root_relief_datum_diameter": 39.0,
        "root_relief_evaluation_reference": 38.4,
    },
    "profile_slope": {
        "profile_slope": 0.004,
        "profile_evaluation_start": 39.0,
        "profile_evaluation_end": 43.0,
    },
    "profile_crowning": {
        "profile_crowning_at_tip": 0.004,
        "profile_crowning_at_root": 0.003,
        "profile_highest_point": 41.0,
    },
    "helix_slope": {
        "helix_slope": 0.004,
        "helix_evaluation_start": 1.0,
        "helix_evaluation_end": 19.0,
        "helix_evaluation_reference": "helix_evaluation_length",
    },
    "helix_crowning": {
        "helix_crowning_amount_datum_face": 0.004,
        "helix_crowning_amount_non_datum_face": 0.003,
        "helix_highest_point": 9.0,
    },
    "end_relief_datum_face": {"end_relief_depth_datum_face": 0.01, "end_relief_length_datum_face": 2.0},
    "end_relief_non_datum_face": {
        "end_relief_depth_non_datum_face": 0.01,
        "end_relief_length_non_datum_face": 2.0,
    },
    "profile_twist": {"profile_twist": 0.004},
    "topographical_modification": {
        "topographical_modification_amounts": (0.0, 0.001, 0.002, 0.003),
        "coordinates_of_topographical_modification": (0.0, 20.0, 0.0, 20.0),
        "diameters_of_topographical_modification": (39.0, 39.0, 43.0, 43.0),
    },
}
LENGTHS = {
    "tip_relief": {
        "tip_relief_depth": 0.01,
        "tip_relief_datum_length": 2.0,
        "tip_relief_evaluation_reference_length": 10.0,
    },
    "root_relief": {
        "root_relief_depth": 0.01,
        "root_relief_datum_length": 1.0,
        "root_relief_evaluation_reference_length": 1.5,
    },
}


def whole_units() -> Iterator[GearUnit]:
    """Yield units that have every attribute of the page, in two writers' ways, and a ring gear."""
    for kinds in (MODIFICATIONS, LENGTHS):
        numbers = dict(zip(kinds, range(60, 80), strict=False))
        yield stage_unit(
            {
                1: {"rotational_speed": 100.0},
                PINION: {
                    "tip_diameter": 44.0,
                    "root_diameter": 35.0,
                    "tip_form_diameter": 43.8,
                    "upper_backlash_allowance_referenced_to_span": -20.0,
                    "lower_backlash_allowance_referenced_to_span": -60.0,
                    "datum_face_orientation": "negative",
                    "u_coordinate_on_shaft": 30.0,
                    "reference_component_for_position": 1,
                    "u_axis_vector": (1.0, 0.0, 0.0),
                    "w_axis_vector": (0.0, 0.0, 1.0),
                },
                PINION_RIGHT: {"addendum_coefficient_basic_profile": 1.0},
                WHEEL: {"inner_diameter": 40.0},
                WHEEL_RIGHT: SECOND,
                WHEEL_LEFT: {"addendum_coefficient_basic_profile": 1.0, **SECOND},
                40: {
                    "addendum_coefficient_reference_profile": 1.25,
                    "tip_corner_radius_factor_reference_profile": 0.3,
                },
                41: UNIT_TOOL,
                42: {"elastic_modulus": 210e3, "poisson_ratio": 0.3},
                43: {"length": 60.0, "outer_diameter_begin": 20.0, "outer_diameter_end": 20.0},
                44: {"is_driving_gear": True},
                45: {"gear_body_rim_thickness": 6.0, "gear_body_web_thickness": 8.0},
                **{numbers[kind]: values for kind, values in kinds.items()},
            },
            {
                40: "rack_shaped_tool",
                41: "rack_shaped_tool",
                42: "material",
                43: "shaft_section",
                44: "cylindrical_stage_gear_data",
                45: "gear_body",
                **{number: kind for kind, number in numbers.items()},
            },
            [
                relation(130, "manufacturing_step", 1, workpiece=WHEEL_RIGHT, tool=40 + (kinds is LENGTHS)),
                relation(131, "reference", origin=PINION, referenced=42),
                relation(132, "assembly", assembly=1, part=43),
                relation(133, "stage_gear_data", stage=STAGE, gear=PINION, stage_gear_data=44),
                relation(134, "assembly", assembly=WHEEL, part=45),
                *(
                    relation(140 + number, "reference", origin=PINION_RIGHT, referenced=number)
                    for number in numbers.values()
                ),
            ],
        )
    yield ring_unit()


def ring_unit() -> GearUnit:
    ring = {
        "number_of_teeth": 60,
        "tip_diameter": 117.0,
        "outer_diameter": 150.0,
        "support_vector": (30.0, 0.0, -40.0),
    }
    cutter = {"number_of_teeth": 25, "addendum_modification_coefficient": 0.0}
    return stage_unit(
        {WHEEL: ring, STAGE: {"center_distance": 40.0}, 46: cutter},
        {WHEEL: "ring_gear", 46: "cutter_wheel_tool"},
        [relation(130, "manufacturing_step", 1, workpiece=WHEEL_RIGHT, tool=46)],
    )


def read_attributes() -> set[str]:
    """Return the attributes of these units that the import takes or derives something from."""
    items = set()
    for unit in whole_units():
        assert len(StageCase.all_of(unit, {})) == 1, [line for line in unit.account.lines() if not line.item]
        items |= {
            line.item
            for line in unit.account.lines()
            if line.item
            and line.fate in ("taken", "derived")
            and unit.part(line.component).attribute(line.item) is not None
        }
    return items


def test_the_page_lists_the_attributes_that_are_read():
    read, _ = PAGE.split("\n## Results\n")
    rows = [row.split("|") for row in read.splitlines() if row.startswith("| ") and "---" not in row]
    listed = {name for row in rows for name in re.findall(r"`([a-z_]+)`", row[2])}
    assert listed == read_attributes()


def test_the_page_lists_every_component_that_modifies_a_flank():
    components = set(re.findall(r"^\| `([a-z_]+)` \|", PAGE, re.MULTILINE))
    assert set(READERS) <= components
    assert not set(UNREAD) & components
    assert set(READERS) == set(MODIFICATIONS)


def test_the_fields_of_the_page_are_fields_of_a_case():
    rows = [row.split("|") for row in PAGE.splitlines() if row.startswith("| ")]
    named = {name for row in rows for name in re.findall(r"`([a-z_]+_(?:um|mm|coefficient))`", row[3])}
    pair = {"center_distance_mm", "normal_module_mm"}
    assert named - pair <= set(GearInput.model_fields) | set(WheelInput.model_fields)


ROLES = {"support_vector", "u_axis_vector", "w_axis_vector", "reference_component_for_position"}


def read_of_bearings() -> set[str]:
    """Return the attributes of bearings, rows and elements that units of every kind are read by."""
    stages = ("operating_", "mounted_", "")
    clearances = [{f"{stage}radial_bearing_clearance": 10.0} for stage in stages]
    limits = {f"{end}_radial_bearing_clearance": 10.0 for end in ("minimum", "maximum")}
    missing = {"operating_radial_bearing_clearance": None}
    units = [on_lines(missing | own) for own in (*clearances, limits)]
    sides = [{f"axial_force_absorption{of}": "positive" for of in ("", "_of_row")}] * 2
    along = [{f"{stage}axial_bearing_clearance": 10.0} for stage in stages]
    along += [{"preload_distance": 8.0}, {"preload_force": 100.0}]
    units += [inside(*(side | own for side in sides)) for own in along]
    lengths, grooves = ROW | {"significant_contact_length_inner_ring": 12.0}, dict(ROW)
    grooves |= {f"raceway_radius_of_{ring}_ring": 4.7 for ring in ("inner", "outer")}
    ball = {"bearing_type": "angular_contact_ball_bearing"}
    units += [inside(*sides, row=lengths), inside(*(side | ball for side in sides), grooves, BALL)]
    lines = [line for unit in units for line in OpenedUnit.of(unit).lines if "rolling" in line.kind]
    stated = {line.item for line in lines if line.item and line.fate in ("taken", "derived")}
    return stated - ROLES - {"u_coordinate_on_shaft_inner_side"}


def test_the_page_lists_the_attributes_of_bearings_that_are_read():
    rows = [row.split("|") for row in page_of("bearings").splitlines() if row.startswith("| ")]
    listed = {name for row in rows[1:] for name in re.findall(r"`([a-z_]+)`", row[2])}
    assert listed == read_of_bearings()
    fields = {name for row in rows[1:] for name in re.findall(r"`([a-z_]+)`", row[3])}
    models = (RollingBearingInput, BallRowInput, RollerRowInput)
    assert fields <= {name for model in models for name in model.model_fields}
