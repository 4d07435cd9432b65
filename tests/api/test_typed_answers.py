"""What the description says of answers: all of it by type, but for what others define."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from described_api import DESCRIPTION

OPEN = {
    "FaultBody.value": "what the caller wrote",
    "Parameter.value[]": "the standard lets a parameter be anything",
    "ValueDescription.schema": "a JSON Schema",
    "ReportPlot.data[]": "a trace of plotly.js",
    "ReportPlot.layout": "a layout of plotly.js",
    "JobInputs.inputs": "the inputs of a job, by its process, whose description has their schemas",
    "ResultFigures": "the figures of a result, by its kind",
}
SCHEMAS = DESCRIPTION["components"]["schemas"]
WORDS = {"title", "description", "examples", "default"}


def is_open(schema: dict[str, Any]) -> bool:
    if schema.get("type") != "object":
        return not set(schema) - WORDS
    others = schema.get("additionalProperties", not {"properties", "patternProperties"} & set(schema))
    return others in (True, {})


def untyped(schema: dict[str, Any], where: str, met: set[str]) -> Iterator[str]:
    """Yield the places in a schema at which anything may stand; each named schema is walked once."""
    name = schema.get("$ref", "").rpartition("/")[2]
    if name:
        if name not in met:
            met.add(name)
            yield from untyped(SCHEMAS[name], name, met)
        return
    if is_open(schema):
        yield where
    for kind in ("anyOf", "oneOf", "prefixItems"):
        for alternative in schema.get(kind, ()):
            yield from untyped(alternative, where, met)
    for kind in ("properties", "patternProperties"):
        for field, inner in schema.get(kind, {}).items():
            yield from untyped(inner, f"{where}.{field}", met)
    for kind, mark in (("items", "[]"), ("additionalProperties", "{}")):
        if isinstance(schema.get(kind), dict):
            yield from untyped(schema[kind], f"{where}{mark}", met)


def test_answers_are_typed_but_for_what_others_define() -> None:
    met: set[str] = set()
    places = [
        place
        for path, methods in DESCRIPTION["paths"].items()
        for method, operation in methods.items()
        for status, response in operation["responses"].items()
        if status.startswith("2")
        for content in response.get("content", {}).values()
        if "schema" in content  # events are text
        for place in untyped(content["schema"], f"{method} {path} {status}", met)
    ]
    assert len(met) > 30 and sorted(places) == sorted(OPEN)
