"""Random values that a JSON schema allows: near the examples of its fields, or anywhere in their bounds."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator, Mapping
from typing import Any

import jsonschema_rs
from hypothesis import assume
from hypothesis import strategies as st

Json = dict[str, Any]
Place = tuple[str | int, ...]


class Fields:
    """The fields of a document's schemas."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self._components = document["components"]
        self._validators: dict[str, jsonschema_rs.Draft202012Validator] = {}

    @st.composite
    def varied(draw: st.DrawFn, self: Fields, body: Json, schema: Json, most: int) -> Json:  # noqa: N805
        """Draw a body that differs in up to `most` fields, those that it leaves out among them."""
        places = list(self.places(schema, body))
        found = copy.deepcopy(body)
        chosen = draw(st.lists(st.sampled_from(places), max_size=most))
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
        """Yield place and schema of every field of the tables that are there."""
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
            least = schema.get("minItems", 0)
            return st.lists(self.value(schema["items"]), min_size=least, max_size=least + 1)
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
