"""Misalignments of a table by a class: the axis of the request, its refusals, the sentence about it."""

from typing import Any

import pytest

from lineofaction.gearbox.convert.case import allowed_misalignment, case_json, table_axes
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated

GEAR = {"teeth": 25, "face_width_mm": 20.0, "bore_diameter_mm": 40.0}
SHAFT = {"length_mm": 100.0, "diameter_mm": 25.0, "position_mm": 50.0}


def case(errors: dict[str, Any], **pinion: Any) -> Case:
    gears = {"pinion": GEAR | pinion, "wheel": GEAR | {"teeth": 50}}
    pair = {"normal_module_mm": 3.0, "center_distance_mm": 112.5, **gears}
    return validated(Case, {"pair": pair, "load": {"torque_n_m": [100.0]}, "errors": errors})


def test_a_class_makes_the_axis_and_says_how():
    made = case({"misalignment_class": 7})
    assert [1e6 * value for value in table_axes(made).misalignments] == pytest.approx([-20, -10, 0, 10, 20])
    allowed = allowed_misalignment(made)
    assert allowed is not None and allowed.text.startswith("misalignment to 20 µm to either side by class 7")
    assert allowed_misalignment(case({"misalignment_um": [0.0, 30.0]})) is None


def test_a_clearance_widens_the_axis_over_the_bearings_of_the_shaft():
    """50 µm over 100 mm are 10 µm over the face: the root of 19.94^2 + 10^2 is 22.3, rounded 22."""
    errors = {"misalignment_class": 7, "bearing_clearance_um": [50.0, 0.0]}
    assert 1e6 * table_axes(case(errors, shaft=SHAFT)).misalignments[-1] == pytest.approx(22.0)
    with pytest.raises(BadInput, match="without the shaft of the pinion") as caught:
        table_axes(case(errors))
    assert caught.value.faults[0].field == "errors.bearing_clearance_um"


@pytest.mark.parametrize(
    ("errors", "field"),
    [
        ({"misalignment_class": 7, "misalignment_um": [0.0, 30.0]}, "misalignment_um"),
        ({"bearing_clearance_um": [10.0, 10.0]}, "bearing_clearance_um"),
        ({"misalignment_class": 12}, "misalignment_class"),
    ],
)
def test_a_class_beside_values_and_a_clearance_without_one_are_refused(errors, field):
    with pytest.raises(BadInput) as caught:
        case(errors)
    assert caught.value.faults[0].field.endswith(field)


def test_a_case_without_a_class_is_stored_as_before():
    assert set(case_json(case({}))["errors"]) == {"misalignment_um", "center_distance_change_mm"}
