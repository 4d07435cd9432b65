"""REXS models of whole gear units: two helical stages on three shafts, stated bearings, a planetary set."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from rexs_stage import DATE, component, relation

from bounds.types import FloatArray
from lineofaction.gearbox.rexs.model import Document, LoadCase, LoadSpectrum, Model, Relation

Values = Mapping[int, Mapping[str, Any]]
ROOT, CASING, INPUT, MIDDLE, OUTPUT = 1, 2, 3, 4, 5
GEARS = (11, 12, 13, 14)
STAGES = (21, 22)
MOTOR, MACHINE, BELT = 41, 42, 44
CENTER_DISTANCES = (80.0 / math.cos(math.radians(15.0)), 90.0 / math.cos(math.radians(10.0)))
ANGLES = (30.0, 200.0)
NORMAL_LOAD, NORMAL_SPEED = 100.0, 1500.0


def place(*point: float, u: Iterable[float] = (1.0, 0.0, 0.0)) -> dict[str, Any]:
    """Return the attributes of a place in the frame of the unit, w along w."""
    return {
        "support_vector": tuple(map(float, point)),
        "u_axis_vector": tuple(u),
        "w_axis_vector": (0.0, 0.0, 1.0),
        "reference_component_for_position": ROOT,
    }


def _across(center_distance: float, angle: float) -> FloatArray:
    turned = math.radians(angle)
    return np.array([0.0, center_distance * math.sin(turned), center_distance * math.cos(turned)])


SECOND = _across(CENTER_DISTANCES[0], ANGLES[0])
THIRD = SECOND + _across(CENTER_DISTANCES[1], ANGLES[1])
_SHAFTS = {INPUT: np.zeros(3), MIDDLE: SECOND, OUTPUT: THIRD}
_TOOTHING = {
    11: (INPUT, 20, 2.0, 15.0, 20.0, 60.0),
    12: (MIDDLE, 60, 2.0, -15.0, 20.0, 60.0),
    13: (MIDDLE, 20, 3.0, -10.0, 30.0, 110.0),
    14: (OUTPUT, 40, 3.0, 10.0, 30.0, 110.0),
}
_BEARINGS = {31: (INPUT, 15.0), 32: (INPUT, 140.0), 33: (MIDDLE, 15.0), 34: (MIDDLE, 140.0)}
_BEARINGS |= {35: (OUTPUT, 15.0), 36: (OUTPUT, 140.0)}


def parts() -> dict[int, tuple[str, dict[str, Any]]]:
    found: dict[int, tuple[str, dict[str, Any]]] = {
        ROOT: ("gear_unit", place(0.0, 0.0, 0.0)),
        CASING: ("gear_casing", {}),
        MOTOR: ("external_load", {"u_coordinate_on_shaft": 0.0, "torque_around_u_axis": NORMAL_LOAD}),
        MACHINE: ("external_load", {"u_coordinate_on_shaft": 150.0, "transmits_torque": True}),
    }
    for shaft, origin in _SHAFTS.items():
        found[shaft] = ("shaft", place(*origin))
        for number, (length, diameter) in enumerate(((50.0, 25.0), (100.0, 30.0))):
            values = {"u_coordinate_on_shaft": 50.0 * number, "length": length}
            values |= {"outer_diameter_begin": diameter, "outer_diameter_end": diameter}
            found[100 + 10 * shaft + number] = ("shaft_section", values)
    found[INPUT][1]["rotational_speed"] = NORMAL_SPEED
    for gear, (shaft, teeth, module, helix, width, u) in _TOOTHING.items():
        values = {"number_of_teeth": teeth, "normal_module": module, "face_width": width}
        values |= {"helix_angle_reference_diameter": helix, "u_coordinate_on_shaft": u}
        found[gear] = ("cylindrical_gear", values | place(*(_SHAFTS[shaft] + [u, 0.0, 0.0])))
        for flank in (200 + gear, 300 + gear):
            shift = {"normal_pressure_angle": 20.0, "addendum_modification_coefficient": 0.0}
            found[flank] = ("cylindrical_gear_flank", shift)
    for stage, center_distance, angle in zip(STAGES, CENTER_DISTANCES, ANGLES, strict=True):
        values = {"center_distance": center_distance, "rotating_angle_around_neg_u_axis": angle}
        found[stage] = ("cylindrical_stage", values)
    for bearing, (shaft, u) in _BEARINGS.items():
        fixed = "both_directions" if u < 100.0 else "no_direction"
        values = {"u_coordinate_on_shaft_inner_side": u, "axial_force_absorption": fixed}
        values |= {"radial_stiffness": 2e8, "axial_stiffness": 1e8, "bending_stiffness": 0.0}
        found[bearing] = ("concept_bearing", values | place(*(_SHAFTS[shaft] + [u, 0.0, 0.0])))
    return found


def relations() -> list[Relation]:
    rows: list[tuple[str, dict[str, int]]] = [
        *(("assembly", {"assembly": shaft, "part": gear}) for gear, (shaft, *_) in _TOOTHING.items()),
        *(("assembly", {"assembly": s, "part": 100 + 10 * s + n}) for s in _SHAFTS for n in (0, 1)),
        ("assembly", {"assembly": INPUT, "part": MOTOR}),
        ("assembly", {"assembly": OUTPUT, "part": MACHINE}),
        ("stage", {"stage": STAGES[0], "gear_1": 11, "gear_2": 12}),
        ("stage", {"stage": STAGES[1], "gear_1": 13, "gear_2": 14}),
        *(("flank", {"gear": gear, "left": 200 + gear, "right": 300 + gear}) for gear in GEARS),
        *(
            ("side", {"assembly": bearing, "inner_part": shaft, "outer_part": CASING})
            for bearing, (shaft, _) in _BEARINGS.items()
        ),
    ]
    return [relation(1000 + number, kind, **roles) for number, (kind, roles) in enumerate(rows)]


Change = Callable[[int, str, dict[str, Any]], dict[str, Any]]


def two_stages(
    changes: Values = MappingProxyType({}),
    each: Change = lambda _number, _kind, values: values,
    more: Mapping[int, tuple[str, dict[str, Any]]] = MappingProxyType({}),
    further: Iterable[Relation] = (),
    cases: Iterable[Mapping[int, tuple[str, Mapping[str, Any]]]] = (),
) -> Document:
    """Return the two-stage unit.

    `changes` are attributes by component (None takes one away), `each` maps the values of every component,
    `more` and `further` add components and relations, `cases` are load cases.
    """
    built = {**parts(), **more}
    components = tuple(
        component(number, kind, each(number, kind, {**values, **changes.get(number, {})}))
        for number, (kind, values) in built.items()
    )
    loads = tuple(
        LoadCase(number, tuple(component(part, kind, values) for part, (kind, values) in case.items()))
        for number, case in enumerate(cases, 1)
    )
    spectra = (LoadSpectrum(1, loads),) if loads else ()
    joined = (*relations(), *further)
    return Document(Model("2.0.0", "test", "1", DATE, joined, components, spectra))


def pulled(shaft: int = INPUT, cases: Iterable[Mapping[str, float]] = (), **values: Any) -> dict[str, Any]:
    """Return what adds an external load of these values to a unit; `cases` are its values by load case."""
    return {
        "more": {BELT: ("external_load", values)},
        "further": [relation(2900, "assembly", assembly=shaft, part=BELT)],
        "cases": [{BELT: ("external_load", case)} for case in cases],
    }


BEVEL: dict[int, tuple[str, dict[str, Any]]] = {
    6: ("shaft", {"support_vector": (180.0, 0.0, 0.0), "u_axis_vector": (0.0, 1.0, 0.0)}),
    15: ("bevel_gear", {"number_of_teeth": 36, "u_coordinate_on_shaft": 150.0}),
    16: ("bevel_gear", {"number_of_teeth": 12, "u_coordinate_on_shaft": 0.0}),
    23: ("bevel_stage", {}),
}
"""A shaft across, on which a bevel stage drives the input shaft."""
BEVEL_RELATIONS = [
    relation(2901, "assembly", assembly=INPUT, part=15),
    relation(2902, "assembly", assembly=6, part=16),
    relation(2903, "stage", stage=23, gear_1=16, gear_2=15),
]


def antiparallel(shaft: int, length: float, **further: Any) -> Document:
    parts = {INPUT: (11, 31, 32, 130, 131, MOTOR, BELT), MIDDLE: (12, 13, 33, 34, 140, 141)}
    on_shaft, turned = parts[shaft], ["rotational_speed"]
    turned += [item for axis in "uv" for item in (f"force_{axis}_direction", f"torque_around_{axis}_axis")]

    def each(number: int, _kind: str, values: dict[str, Any]) -> dict[str, Any]:
        if number == shaft:
            x, y, z = values["support_vector"]
            values = values | {"support_vector": (x + length, y, z), "u_axis_vector": (-1.0, 0.0, 0.0)}
        if number not in (shaft, *on_shaft):
            return values
        values = {item: -value if item in turned else value for item, value in values.items()}
        for item in ("u_coordinate_on_shaft", "u_coordinate_on_shaft_inner_side"):
            if item in values:
                values = values | {item: length - values[item] - values.get("length", 0.0)}
        return values | ({"u_axis_vector": (-1.0, 0.0, 0.0)} if "u_axis_vector" in values else {})

    return two_stages(each=each, **further)


def mirrored(**further: Any) -> Document:
    """Return the mirror image in the plane v = 0: hands and senses of rotation are opposite."""
    opposite = ("helix_angle_reference_diameter", "rotational_speed", "torque_around_u_axis")
    opposite += ("rotating_angle_around_neg_u_axis", "force_v_direction", "torque_around_w_axis")

    def each(_number: int, _kind: str, values: dict[str, Any]) -> dict[str, Any]:
        values = {k: -v if k in opposite else v for k, v in values.items()}
        if "support_vector" in values:
            x, y, z = values["support_vector"]
            values["support_vector"] = (x, -y, z)
        return values

    return two_stages(each=each, **further)


SUN, RING, CARRIER, PLANETS, SET = 3, 4, 5, (6, 7, 8), 20
PLANET_TEETH, SUN_TEETH, RING_TEETH = 22, 20, 64


def planetary(turned: float = 0.0, step: int = 0) -> Document:
    """Return a planetary set: sun 20, three planets 22, ring 64 held by a coupling; turned about u (deg).

    With a `step` the planets have a second gear of so many teeth, which meshes with a ring of 42 more.
    """
    built: dict[int, tuple[str, dict[str, Any]]] = {
        ROOT: ("gear_unit", place(0.0, 0.0, 0.0)),
        CASING: ("gear_casing", {}),
        SUN: ("shaft", place(0.0, 0.0, 0.0) | {"rotational_speed": 1000.0}),
        RING: ("shaft", place(0.0, 0.0, 0.0)),
        CARRIER: ("shaft", place(-60.0, 0.0, 0.0)),
        SET: ("planetary_stage", {}),
        90: (
            "coupling",
            place(20.0, 0.0, 0.0) | dict.fromkeys(("radial_stiffness", "axial_stiffness"), 1e23),
        ),
        MOTOR: ("external_load", {"u_coordinate_on_shaft": 0.0, "torque_around_u_axis": 90.0}),
        MACHINE: ("external_load", {"u_coordinate_on_shaft": 0.0, "transmits_torque": True}),
    }
    rows: list[tuple[str, dict[str, int]]] = [
        ("side", {"assembly": 90, "inner_part": RING, "outer_part": CASING}),
        ("assembly", {"assembly": SUN, "part": MOTOR}),
        ("assembly", {"assembly": CARRIER, "part": MACHINE}),
        ("central_shaft", {"planetary_stage": SET, "shaft": SUN}),
        ("central_shaft", {"planetary_stage": SET, "shaft": RING}),
        ("planet_carrier_shaft", {"planetary_stage": SET, "shaft": CARRIER}),
    ]
    built[90][1]["rotational_stiffness"] = 1e20

    def gear(number: int, shaft: int, kind: str, teeth: int) -> None:
        values = {"number_of_teeth": teeth, "normal_module": 2.0, "face_width": 20.0}
        values |= {"helix_angle_reference_diameter": 0.0, "u_coordinate_on_shaft": 20.0}
        built[number] = (kind, values)
        shift = {"normal_pressure_angle": 20.0, "addendum_modification_coefficient": 0.0}
        for flank in (200 + number, 300 + number):
            built[flank] = ("cylindrical_gear_flank", shift)
        rows.append(("assembly", {"assembly": shaft, "part": number}))
        rows.append(("flank", {"gear": number, "left": 200 + number, "right": 300 + number}))

    gear(11, SUN, "cylindrical_gear", SUN_TEETH)
    gear(12, RING, "ring_gear", step + 42 if step else RING_TEETH)
    for number, planet in enumerate(PLANETS):
        built[planet] = ("shaft", place(*_across(42.0, turned + 120.0 * number)))
        gear(13 + number, planet, "cylindrical_gear", PLANET_TEETH)
        rows.append(("planet_shaft", {"planetary_stage": SET, "shaft": planet}))
        built[21 + number] = ("cylindrical_stage", {"center_distance": 42.0})
        built[24 + number] = ("cylindrical_stage", {"center_distance": 42.0})
        rows.append(("stage", {"stage": 21 + number, "gear_1": 11, "gear_2": 13 + number}))
        if step:
            gear(16 + number, planet, "cylindrical_gear", step)
        rows.append(("stage", {"stage": 24 + number, "gear_1": (16 if step else 13) + number, "gear_2": 12}))
        at = {"u_coordinate_on_shaft_outer_side": 20.0, "radial_stiffness": 1e20}
        built[31 + number] = ("concept_bearing", at)
        rows.append(("side", {"assembly": 31 + number, "inner_part": CARRIER, "outer_part": planet}))
    for bearing, shaft in ((41 + 10, SUN), (42 + 10, CARRIER)):
        at = {"u_coordinate_on_shaft_inner_side": 5.0, "radial_stiffness": 1e8, "axial_stiffness": 1e8}
        built[bearing] = ("concept_bearing", at)
        rows.append(("side", {"assembly": bearing, "inner_part": shaft, "outer_part": CASING}))
    components = tuple(component(number, kind, values) for number, (kind, values) in built.items())
    joined = tuple(relation(1000 + number, kind, **roles) for number, (kind, roles) in enumerate(rows))
    return Document(Model("2.0.0", "test", "1", DATE, joined, components))


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
Stated = Mapping[str, Any]


def at(number: int, kind: str, values: Stated) -> dict[int, tuple[str, dict[str, Any]]]:
    """Return a bearing of the input shaft in place of the usual one."""
    u = 15.0 if number == LEFT else 140.0
    stands = place(u, 0.0, 0.0) | {"u_coordinate_on_shaft_inner_side": u}
    return {number: (f"rolling_bearing_with_{kind}_geometry", {**stands, **values})}


def on_lines(left: Stated, right: Stated | None = None, torques: Sequence[float] = ()) -> Document:
    """Return the unit with deep groove ball bearings by catalog lines on its input shaft.

    `torques` of the motor about u, N m, make load cases.
    """
    lines = at(LEFT, "catalog", LINE | left) | at(RIGHT, "catalog", LINE | (left if right is None else right))
    cases = [{MOTOR: ("external_load", {"torque_around_u_axis": torque})} for torque in torques]
    return two_stages(more=lines, cases=cases)


def inside(left: Stated, right: Stated, row: Stated = ROW, element: Stated = ROLLER) -> Document:
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
