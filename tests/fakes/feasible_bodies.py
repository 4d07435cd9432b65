"""Bodies of requests that mean something: feasible pairs, and values of fields near their examples."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator, Mapping
from typing import Any

import jsonschema_rs
from hypothesis import assume
from hypothesis import strategies as st
from toml_text import toml_text

from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import Gear, GearPair, InternalGearPair, RingGear
from lineofaction.gearbox.schemas.case import OF_PAIR
from lineofaction.gearbox.schemas.declared import figures
from service.schemas.examples import request_example

Json = dict[str, Any]
Place = tuple[str | int, ...]


class Fields:
    def __init__(self, document: Mapping[str, Any]) -> None:
        self._components = document["components"]
        self._validators: dict[str, jsonschema_rs.Draft202012Validator] = {}

    @st.composite
    def varied(draw: st.DrawFn, self: Fields, body: Json, schema: Json, maximum: int) -> Json:  # noqa: N805
        """Draw a body that differs in up to `maximum` fields, those that it leaves out among them."""
        places = list(self.places(schema, body))
        found = copy.deepcopy(body)
        chosen = draw(st.lists(st.sampled_from(places), max_size=maximum))
        for place, field in sorted(chosen, key=lambda one: -len(one[0])):  # tables after what is in them
            _put(found, place, draw(self.value(field)))
        assume(self.allows(schema, found))
        return found

    def allows(self, schema: Json, body: Json) -> bool:
        name = json.dumps(schema)
        if name not in self._validators:
            whole = schema | {"components": self._components}
            self._validators[name] = jsonschema_rs.Draft202012Validator(whole)
        return self._validators[name].is_valid(body)

    def places(self, schema: Json, value: Any, place: Place = ()) -> Iterator[tuple[Place, Json]]:
        schema = self.resolved(schema)
        if isinstance(value, list) and value and isinstance(value[0], dict):
            for index, entry in enumerate(value):
                yield from self.places(schema["items"], entry, (*place, index))
        if isinstance(value, dict):
            for name, field in schema.get("properties", {}).items():
                yield (*place, name), field
                yield from self.places(field, value.get(name), (*place, name))

    def resolved(self, schema: Json) -> Json:
        """Return a schema without references and without null; what is said beside them stays."""
        while True:
            if "$ref" in schema:
                named = self._components["schemas"][schema["$ref"].rpartition("/")[2]]
            elif "anyOf" in schema:
                named = next(each for each in schema["anyOf"] if each != {"type": "null"})
            else:
                return schema
            schema = named | {key: schema[key] for key in ("examples",) if key in schema}

    def value(self, schema: Json) -> st.SearchStrategy[Any]:
        """Return the values of a field: mostly near its example, some anywhere within its bounds."""
        schema = self.resolved(schema)
        if "examples" in schema:
            near = st.sampled_from(schema["examples"]).flatmap(lambda example: self.near(example, schema))
            return st.one_of(*(8 * [near]), self.anywhere(schema)) if _is_number(schema) else near
        return self.anywhere(schema)

    def near(self, example: Any, schema: Json) -> st.SearchStrategy[Any]:
        """Return values like an example; lists of numbers are scaled, so that they stay in order."""
        schema = self.resolved(schema)
        if isinstance(example, dict):
            fields, others = schema.get("properties", {}), _schema_of_others(schema)
            return st.fixed_dictionaries(
                {name: self.near(value, fields.get(name, others)) for name, value in example.items()}
            )
        if isinstance(example, list):
            items = self.resolved(schema.get("items", {}))
            if _is_number(items):
                return _FACTORS.map(lambda factor: [_within(factor * value, items) for value in example])
            return st.tuples(*(self.near(value, items) for value in example)).map(list)
        if _is_number(schema):
            return _FACTORS.map(lambda factor: _within(factor * example, schema))
        as_it_is = "type" not in schema or (schema["type"] == "string" and "enum" not in schema)
        return st.just(example) if as_it_is else self.anywhere(schema)

    def anywhere(self, schema: Json) -> st.SearchStrategy[Any]:
        """Return all values that the bounds allow; texts and tables have few."""
        if "enum" in schema or "const" in schema:
            return st.sampled_from(schema.get("enum", [schema.get("const")]))
        if _is_number(schema):
            low, high = _ends(schema)
            wide = st.floats(0.0, 1.0).map(lambda share: _within(low + share * (high - low), schema))
            return wide | st.sampled_from([_within(low, schema), _within(high, schema)])
        if schema.get("type") == "object":
            required = schema.get("required", [])
            return st.fixed_dictionaries({name: self.value(schema["properties"][name]) for name in required})
        if schema.get("type") == "array":
            minimum = schema.get("minItems", 0)
            return st.lists(self.value(schema["items"]), min_size=minimum, max_size=minimum + 1)
        return st.booleans() if schema.get("type") == "boolean" else st.just(schema.get("default", "name"))


def _schema_of_others(schema: Json) -> Json:
    """Return the schema of the fields that an object does not name; empty: it allows anything."""
    others = schema.get("additionalProperties", {})
    return others if isinstance(others, dict) else {}


_FACTORS = st.sampled_from([1.0]) | st.floats(0.5, 2.0)


def _put(body: Any, place: Place, value: Any) -> None:
    for key in place[:-1]:
        body = body[key]
    body[place[-1]] = value


def _is_number(schema: Json) -> bool:
    return schema.get("type") in ("number", "integer")


def _ends(schema: Json) -> tuple[float, float]:
    low = schema.get("minimum", schema.get("exclusiveMinimum", -1e6))
    return low, schema.get("maximum", schema.get("exclusiveMaximum", 1e6))


def _within(value: float, schema: Json) -> float:
    low, high = _ends(schema)
    whole = schema["type"] == "integer"
    if "exclusiveMinimum" in schema:
        low = low + 1 if whole else math.nextafter(low, math.inf)
    if "exclusiveMaximum" in schema:
        high = high - 1 if whole else math.nextafter(high, -math.inf)
    found = min(max(value, low), high)
    return round(found) if whole else float(found)


RACK = ("normal_module", "normal_pressure_angle", "helix_angle")
GEAR = ("teeth", "face_width", "bore_diameter", "rim_diameter", "profile_shift_coefficient")
HEIGHTS = ("addendum_coefficient", "dedendum_coefficient")
LINE_LOADS = st.floats(2e6, 4e7)
"""Force over face width and module, Pa."""


@st.composite
def cases(draw: st.DrawFn) -> Json:
    """Draw a pair, one to four torques and a model."""
    pair: Any = draw(external_pairs() | internal_pairs())
    width, module = pair.pinion.face_width, pair.pinion.normal_module
    highest = draw(LINE_LOADS) * width * module * pair.pinion.base_radius
    torques = [float(f"{highest * share:.4g}") for share in (0.1, 0.3, 0.6, 1.0)]
    accuracy = draw(st.sampled_from(({}, {"level": "draft"}, {"tolerance": 0.02}, {"time_budget_s": 30.0})))
    return {
        "pair": _written(pair.pinion, OF_PAIR, RACK)
        | _written(pair, OF_PAIR, ("center_distance",))
        | {"pinion": _gear(pair.pinion), "wheel": _gear(pair.wheel)},
        "load": {"torque_n_m": torques[draw(st.integers(0, 3)) :]},
        "accuracy": accuracy,
    }


@st.composite
def external_pairs(draw: st.DrawFn) -> GearPair:
    """Draw two external gears, 0.01 to 0.08 modules further apart than without backlash."""
    rack = draw(_racks())
    pinion, wheel = (
        draw(_gears(rack | {"helix_angle": hand * rack["helix_angle"]}, 14, 100)) for hand in (1, -1)
    )
    return _apart(draw, pinion, wheel)


@st.composite
def internal_pairs(draw: st.DrawFn) -> InternalGearPair:
    rack = draw(_racks())
    pinion = draw(_gears(rack, 16, 40))
    module, teeth = rack["normal_module"], pinion.teeth + draw(st.integers(25, 80))
    sizes = {"face_width": pinion.face_width, "rim_diameter": 1.3 * (teeth + 8) * module * 1.2}
    shift = draw(st.floats(-0.2, 0.2))
    try:
        ring = RingGear(
            teeth=teeth, profile_shift_coefficient=shift, addendum_coefficient=0.75, **(rack | sizes)
        )
    except InfeasibleGeometry:
        assume(False)
        raise
    return _apart(draw, pinion, ring)


@st.composite
def _racks(draw: st.DrawFn) -> dict[str, float]:
    """Draw a basic rack; half of them spur."""
    return {
        "normal_module": draw(st.floats(1e-3, 12e-3)),
        "normal_pressure_angle": draw(st.floats(0.3, 0.42)),
        "helix_angle": draw(st.sampled_from([0.0]) | st.floats(0.05, 0.55)),
    }


@st.composite
def _gears(draw: st.DrawFn, rack: dict[str, float], minimum: int, maximum: int) -> Gear:
    module, teeth = rack["normal_module"], draw(st.integers(minimum, maximum))
    sizes = {"face_width": draw(st.floats(4.0, 15.0)) * module, "bore_diameter": 0.4 * teeth * module}
    shift = draw(st.floats(0.4 if teeth < 17 else -0.2, 0.6))
    try:
        return Gear(teeth=teeth, profile_shift_coefficient=shift, **(rack | sizes))
    except InfeasibleGeometry:
        assume(False)
        raise


def _apart(draw: st.DrawFn, pinion: Gear, wheel: Any) -> Any:
    kind, sign = (InternalGearPair, -1.0) if isinstance(wheel, RingGear) else (GearPair, 1.0)
    more = sign * draw(st.floats(0.01, 0.08)) * pinion.normal_module
    try:
        return kind(pinion, wheel, kind(pinion, wheel).center_distance + more)
    except InfeasibleGeometry:
        assume(False)
        raise


def _gear(gear: Any) -> Json:
    heights = HEIGHTS if isinstance(gear, RingGear) else ()
    kind = {"internal": True} if isinstance(gear, RingGear) else {}
    return kind | _written(gear, figures(type(gear)), (*GEAR, *heights))


def _written(part: Any, declared: Any, names: tuple[str, ...]) -> Json:
    return {
        figure.field: figure.boundary_value(getattr(part, figure.name))
        for figure in declared
        if figure.name in names
    }


JSON = "application/json"
MAX_CHANGES = 2


class FeasibleBodies:
    """The bodies of the operations of a document; `examples` by path are in place of the document's."""

    def __init__(self, document: Mapping[str, Any], examples: Mapping[str, Json]) -> None:
        self._paths = document["paths"]
        self._fields = Fields(document)
        self._examples = examples

    def of(self, path: str, method: str) -> st.SearchStrategy[Json] | None:
        """Return the bodies of an operation; None where they are more than JSON, or have no example."""
        content = self._paths[path][method]["requestBody"]["content"]
        example = self._examples.get(path) or request_example(path)
        if list(content) != [JSON] or example is None:
            return None
        schema = content[JSON]["schema"]
        bodies = cases().map(lambda case: about(example, case))
        return bodies.flatmap(lambda body: self._fields.varied(body, schema, MAX_CHANGES))


def about(example: Json, case: Json) -> Json:
    body = copy.deepcopy(example)
    inputs = body.get("inputs", {})
    if "case" in inputs:
        inputs["case"] = case
        inputs.pop("variables", None)  # their lengths are those of another module
    if "frequency_hz" in inputs:  # which its teeth pass
        inputs["frequency_hz"] = case["pair"]["pinion"]["teeth"] * inputs["speed_rpm"] / 60.0
    if "after" in inputs:
        inputs["after"] = _relieved(case)
    if "scene" in inputs:
        _put_in(inputs["scene"], case)
    if "toml" in body and "shafts" not in body["toml"]:
        body["toml"] = toml_text(case)
    return body


def _relieved(case: Json) -> Json:
    relieved = copy.deepcopy(case)
    for name in ("pinion", "wheel"):
        module = case["pair"]["normal_module_mm"]
        relieved["pair"][name] |= {"tip_relief_um": 4.0 * module, "tip_relief_length_mm": 0.3 * module}
    return relieved


def _put_in(scene: Json, case: Json) -> None:
    pair = case["pair"]
    scene["meshes"][0]["case"] = case
    distance = -pair["center_distance_mm"] if pair["wheel"].get("internal") else pair["center_distance_mm"]
    scene["shafts"][1]["origin_mm"] = [distance, 0.0, 0.0]
    for gear, name in zip(scene["gears"], ("pinion", "wheel"), strict=True):
        gear["bore_diameter_mm"] = pair[name].get("bore_diameter_mm", 0.0)
