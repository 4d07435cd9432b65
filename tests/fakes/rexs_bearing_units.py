"""Units of REXS on stated bearings, by catalog lines and by what is inside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from lineofaction.gearbox.rexs.model import Document
from tests.fakes.rexs_stage import relation
from tests.fakes.rexs_unit import MOTOR, place, two_stages

LEFT, RIGHT = 31, 32  # of the input shaft, at u = 15 and 140 mm
LINE = {
    "bearing_type": "radial_grooved_ball_bearing",
    "inner_diameter": 25.0,
    "outer_diameter": 62.0,
    "radial_static_load_rating": 11.6,
    "radial_dynamic_load_rating": 23.4,
    "operating_radial_bearing_clearance": 10.0,
}
INSIDE = {"bearing_type": "radial_tapered_roller_bearing", "radial_static_load_rating": 56.0}
ROW = {"number_of_rolling_elements": 17, "reference_diameter_rolling_bearing": 54.0, "pressure_angle": 14.0}
ROLLER = {"diameter_of_rolling_element": 9.0, "length_of_rolling_element": 12.5}
BALL = {"diameter_of_rolling_element": 9.0}
Values = Mapping[str, Any]


def at(number: int, kind: str, values: Values) -> dict[int, tuple[str, dict[str, Any]]]:
    """Return a bearing of the input shaft in place of the usual one."""
    u = 15.0 if number == LEFT else 140.0
    stands = place(u, 0.0, 0.0) | {"u_coordinate_on_shaft_inner_side": u}
    return {number: (f"rolling_bearing_with_{kind}_geometry", {**stands, **values})}


def on_lines(left: Values, right: Values | None = None, torques: Sequence[float] = ()) -> Document:
    """Return the unit with deep groove ball bearings by catalog lines on its input shaft.

    `torques` of the motor about u, N m, make load cases.
    """
    lines = at(LEFT, "catalog", LINE | left) | at(RIGHT, "catalog", LINE | (left if right is None else right))
    cases = [{MOTOR: ("external_load", {"torque_around_u_axis": torque})} for torque in torques]
    return two_stages(more=lines, cases=cases)


def inside(left: Values, right: Values, row: Values = ROW, element: Values = ROLLER) -> Document:
    """Return the unit with bearings of a row by their internal geometry on its input shaft."""
    more, further = {}, []
    for number, own in ((LEFT, left), (RIGHT, right)):
        of_row = {name: value for name, value in own.items() if name.endswith("_of_row")}
        more |= at(number, "detailed", INSIDE | {k: v for k, v in own.items() if k not in of_row})
        more[10 * number] = ("rolling_bearing_row", {**row, **of_row})
        more[10 * number + 1] = ("rolling_element", dict(element))
        further += [
            relation(10 * number, "assembly", assembly=number, part=10 * number),
            relation(10 * number + 1, "assembly", assembly=10 * number, part=10 * number + 1),
        ]
    return two_stages(more=more, further=further)
