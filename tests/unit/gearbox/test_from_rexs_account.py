"""Components of a REXS file: the account of an import, one line for every value, and their frames."""

import math
from typing import Any

import numpy as np
import pytest
from rexs_stage import PINION, stage_unit

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.placement import frame_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import (
    Attribute,
    Component,
    LoadCase,
    LoadSpectrum,
    Model,
    Reference,
    Relation,
)

MODULE = Attribute("normal_module", "floating_point", 4.5, "mm")
HELIX = Attribute("helix_angle_reference_diameter", "floating_point", 21.0, "deg")
COLOR = Attribute("custom_color", "string", "red")


def unit() -> GearUnit:
    parts = (
        Component(1, "shaft", name="input"),
        Component(2, "cylindrical_gear", (MODULE, HELIX, COLOR)),
        Component(3, "shaft_section"),
        Component(4, "shaft_section"),
    )

    def owned(number, kind, part, order=None):
        return Relation(number, kind, (Reference(1, "assembly"), Reference(part, "part")), order)

    relations = (
        owned(1, "assembly", 2),
        owned(2, "ordered_assembly", 4, order=2),
        owned(3, "ordered_assembly", 3, order=1),
    )
    case = LoadCase(
        1, (Component(1, "shaft", (Attribute("rotational_speed", "floating_point", 60.0, "1 / min"),)),)
    )
    return GearUnit(Model("2.0.0", "test", "1", "2026-01-01", relations, parts, (LoadSpectrum(1, (case,)),)))


def fates(gears: GearUnit) -> dict[tuple[str, str], str]:
    return {(line.place, line.item): line.fate for line in gears.account.lines()}


def test_each_component_and_attribute_has_exactly_one_line():
    gears = unit()
    lines = [(line.place, line.item) for line in gears.account.lines()]
    expected = [
        (place, item)
        for place, part in gears.model.all_components()
        for item in ("", *(attribute.id for attribute in part.attributes))
    ]
    assert lines == expected


def test_what_is_read_is_taken_and_what_is_not_is_ignored():
    gears = unit()
    gear = gears.part(2)
    assert gear.number("normal_module", "normal_module_mm") == pytest.approx(4.5e-3, rel=1e-15)
    assert gear.number("face_width", "face_width_mm") is None
    said = fates(gears)
    assert said["component 2", "normal_module"] == "taken"
    assert said["component 2", "custom_color"] == "ignored"
    assert said["component 2", ""] == "taken"
    assert said["component 3", ""] == "ignored"
    assert ("component 2", "face_width") not in said


def test_the_last_word_counts_and_a_value_that_lacks_can_be_said():
    gears = unit()
    gear = gears.part(2)
    gear.number("helix_angle_reference_diameter", "helix_angle_deg")
    gear.say("helix_angle_reference_diameter", "refused", "outside the bounds")
    gear.say("addendum_modification_coefficient", "derived", "from the center distance")
    said = fates(gears)
    assert said["component 2", "helix_angle_reference_diameter"] == "refused"
    assert said["component 2", "addendum_modification_coefficient"] == "derived"


def test_parts_come_in_the_order_of_an_ordered_assembly():
    gears = unit()
    shaft = gears.part(1)
    assert [part.id for part in shaft.children("shaft_section")] == [3, 4]
    assert {part.id for part in shaft.children()} == {2, 3, 4}
    owner = gears.part(4).shaft
    assert owner.id == 1


def test_load_cases_have_lines_of_their_own():
    gears = unit()
    ((shaft,),) = gears.load_cases()
    assert shaft.number("rotational_speed", "speed_rpm") == pytest.approx(2.0 * math.pi, rel=1e-15)
    place = "load spectrum 1, load case 1, component 1"
    assert fates(gears)[place, "rotational_speed"] == "taken"
    assert fates(gears)["component 1", ""] == "ignored"


def frame_with(**values: Any) -> Any:
    unit = stage_unit({PINION: values})
    return frame_of(unit.part(PINION)), unit


def test_a_frame_within_a_turned_frame_is_turned_with_it():
    # Shaft 1 points along w of the unit; 30 mm along its u axis is 30 mm along w.
    turned = {
        "support_vector": (1.0, 2.0, 3.0),
        "u_axis_vector": (0.0, 0.0, 1.0),
        "w_axis_vector": (1.0, 0.0, 0.0),
    }
    unit = stage_unit({1: turned, PINION: {"reference_component_for_position": 1}})
    frame = frame_of(unit.part(PINION))
    assert frame.origin == pytest.approx([1e-3, 2e-3, 33e-3], rel=1e-12)
    assert frame.u == pytest.approx([0.0, 0.0, 1.0], abs=1e-15)
    assert np.linalg.det(frame.axes) == pytest.approx(1.0, rel=1e-12)


def test_a_gear_without_a_place_stands_at_its_coordinate_on_the_shaft():
    frame, _ = frame_with(support_vector=None, u_coordinate_on_shaft=12.0)
    assert frame.origin == pytest.approx([12e-3, 0.0, 0.0], rel=1e-12)


def test_a_vector_that_is_none_is_left_out_and_said():
    frame, unit = frame_with(u_axis_vector=False)
    assert frame.u == pytest.approx([1.0, 0.0, 0.0])
    fates = {(line.component, line.item): line.fate for line in unit.account.lines()}
    assert fates[PINION, "u_axis_vector"] == "refused"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"u_axis_vector": (0.0, 0.0, 0.0)}, "a direction"),
        ({"u_axis_vector": (0.0, 0.0, 2.0), "w_axis_vector": (0.0, 0.0, 1.0)}, "not along u_axis_vector"),
    ],
)
def test_a_frame_that_is_none_is_refused(values, words):
    with pytest.raises(BadInput, match=words):
        frame_with(**values)


def test_frames_in_a_circle_are_refused():
    unit = stage_unit(
        {
            PINION: {"reference_component_for_position": 1},
            1: {"reference_component_for_position": PINION},
        }
    )
    with pytest.raises(BadInput, match="not placed by this one itself"):
        frame_of(unit.part(PINION))


def test_a_part_of_a_shaft_that_another_refers_to_carries_it():
    """The pinion has no place but its coordinate; what refers to it stands there too."""
    changes = {
        PINION: {"support_vector": None, "u_coordinate_on_shaft": 12.0},
        2: {"support_vector": (0.0, 0.0, 80.0), "reference_component_for_position": PINION},
    }
    unit = stage_unit(changes)
    assert frame_of(unit.part(2)).origin == pytest.approx([12e-3, 0.0, 80e-3], rel=1e-12)
