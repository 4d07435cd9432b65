"""A REXS model of one cylindrical stage: pinion 11 on shaft 1, wheel 12 on shaft 2, stage 20."""

import tomllib
from collections.abc import Iterable, Mapping
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.rexs.model import Attribute, Component, Model, Reference, Relation

PINION, WHEEL, STAGE = 11, 12, 20
PINION_LEFT, PINION_RIGHT, WHEEL_LEFT, WHEEL_RIGHT = 31, 32, 33, 34
_TABLE = tomllib.loads(
    files("lineofaction.gearbox.rexs").joinpath("quantities.toml").read_text(encoding="utf-8")
)
UNITS = {name: unit for unit, names in _TABLE.items() for name in names}

DATE = "2026-01-01T00:00:00+00:00"
Values = Mapping[int, Mapping[str, Any]]

GEARS: dict[int, dict[str, Any]] = {
    1: {"support_vector": (0.0, 0.0, 0.0)},
    2: {"support_vector": (0.0, 0.0, 80.0)},
    PINION: {
        "number_of_teeth": 20,
        "normal_module": 2.0,
        "face_width": 20.0,
        "helix_angle_reference_diameter": 0.0,
        "support_vector": (30.0, 0.0, 0.0),
    },
    WHEEL: {
        "number_of_teeth": 60,
        "normal_module": 2.0,
        "face_width": 20.0,
        "helix_angle_reference_diameter": 0.0,
        "support_vector": (30.0, 0.0, 80.0),
    },
    STAGE: {"center_distance": 80.0},
    **{
        flank: {"normal_pressure_angle": 20.0, "addendum_modification_coefficient": 0.0}
        for flank in (PINION_LEFT, PINION_RIGHT, WHEEL_LEFT, WHEEL_RIGHT)
    },
}
_TYPES = {
    1: "shaft",
    2: "shaft",
    PINION: "cylindrical_gear",
    WHEEL: "cylindrical_gear",
    STAGE: "cylindrical_stage",
    **dict.fromkeys((PINION_LEFT, PINION_RIGHT, WHEEL_LEFT, WHEEL_RIGHT), "cylindrical_gear_flank"),
}


def relation(number: int, kind: str, order: int | None = None, **roles: int) -> Relation:
    return Relation(number, kind, tuple(Reference(part, role) for role, part in roles.items()), order)


_RELATIONS = (
    relation(101, "assembly", assembly=1, part=PINION),
    relation(102, "assembly", assembly=2, part=WHEEL),
    relation(103, "stage", stage=STAGE, gear_1=PINION, gear_2=WHEEL),
    relation(104, "flank", gear=PINION, left=PINION_LEFT, right=PINION_RIGHT),
    relation(105, "flank", gear=WHEEL, left=WHEEL_LEFT, right=WHEEL_RIGHT),
)


def attribute(name: str, value: Any) -> Attribute:
    unit = UNITS.get(name, "none")
    if isinstance(value, bool):
        return Attribute(name, "boolean", value, unit)
    if isinstance(value, str):
        return Attribute(name, "enum", value, unit)
    if name == "reference_component_for_position":
        return Attribute(name, "reference_component", value, "none")
    if isinstance(value, int):
        return Attribute(name, "integer", value, unit)
    if isinstance(value, tuple) and isinstance(value[0], tuple):
        return Attribute(name, "floating_point_matrix", value, unit)
    return Attribute(name, f"floating_point{'_array' * isinstance(value, tuple)}", value, unit)


def component(number: int, kind: str, values: Mapping[str, Any]) -> Component:
    """Return a component; None leaves an attribute out."""
    kept = {name: value for name, value in values.items() if value is not None}
    return Component(number, kind, tuple(attribute(n, v) for n, v in kept.items()), f"{kind} {number}")


def stage_unit(
    changes: Values = MappingProxyType({}),
    types: Mapping[int, str] = MappingProxyType({}),
    relations: Iterable[Relation] = (),
) -> GearUnit:
    """Return the unit with attributes changed or added by component; None takes one away.

    `types` adds components or gives them another type; `relations` are further ones.
    """
    kinds = {**_TYPES, **types}
    components = tuple(
        component(number, kind, {**GEARS.get(number, {}), **changes.get(number, {})})
        for number, kind in kinds.items()
    )
    return GearUnit(Model("2.0.0", "test", "1", DATE, (*_RELATIONS, *relations), components))
