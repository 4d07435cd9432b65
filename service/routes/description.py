"""The description of the API as a resource."""

from __future__ import annotations

import json
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from service.access import Scope
from service.page.files import PageFile
from service.routes.media_types import JSON, OPENAPI, OPENAPI_30, media_type, negotiated
from service.routes.page import served
from service.routes.scopes import ScopedRoute, needs

# The description in OpenAPI 3.0, for clients of OGC API that know no other (requirements class oas30).


Json = dict[str, Any]

VERSION = "3.0.3"

_UNKNOWN = ("if", "then", "else", "contentMediaType", "contentEncoding", "propertyNames", "$defs")
"""Of JSON Schema, not of OpenAPI 3.0."""
_EXAMPLES = ("example", "examples", "value")
_PARTS = ("anyOf", "oneOf", "allOf")
_NULL = {"type": "null"}


def in_version_30(document: Json) -> Json:
    """Return a description of OpenAPI 3.1 in 3.0."""
    info = {name: value for name, value in document["info"].items() if name != "summary"}
    info["license"] = {"name": info["license"]["name"]}
    components = {
        **_converted(document["components"]),
        "schemas": {name: _schema(schema) for name, schema in document["components"]["schemas"].items()},
    }
    return {**_converted(document), "openapi": VERSION, "info": info, "components": components}


def _converted(part: Any) -> Any:
    """Return a part that is no schema, its schemas converted."""
    if isinstance(part, list):
        return [_converted(entry) for entry in part]
    if not isinstance(part, dict):
        return part
    return {
        name: _schema(value)
        if name == "schema"
        else value
        if name in _EXAMPLES or name == "schemas"
        else _converted(value)
        for name, value in part.items()
    }


def _schema(schema: Any) -> Any:
    """Return a schema of 3.0."""
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema:
        return _referring(schema)
    found = {name: value for name, value in schema.items() if name not in _UNKNOWN}
    _move_words(found)
    _move_bounds(found)
    for name in _PARTS:
        if name in found:
            _convert_alternatives(found, name)
    for name in ("items", "additionalProperties", "not"):
        if name in found:
            found[name] = _schema(found[name])
    if "properties" in found:
        found["properties"] = {name: _schema(value) for name, value in found["properties"].items()}
    if found.get("type") == "array":
        found.setdefault("items", {})
    return found


def _referring(schema: Json) -> Json:
    """Return a reference; what stands beside it needs a schema around both."""
    reference = {"$ref": schema["$ref"]}
    beside = _schema({name: value for name, value in schema.items() if name != "$ref"})
    return beside | {"allOf": [reference]} if beside else reference


def _move_words(schema: Json) -> None:
    """Give constants and examples the names that they have in 3.0."""
    if "const" in schema:
        schema["enum"] = [schema.pop("const")]
    if schema.get("examples"):
        schema["example"] = schema["examples"][0]
    schema.pop("examples", None)
    for named in schema.pop("patternProperties", {}).values():
        schema["additionalProperties"] = named


def _move_bounds(schema: Json) -> None:
    """Mark open bounds beside their numbers."""
    for open_end, end in (("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")):
        if open_end in schema:
            schema |= {end: schema[open_end], open_end: True}


def _convert_alternatives(schema: Json, name: str) -> None:
    """Convert the parts of a schema: null is a mark of it, and rules over several fields are left out."""
    parts = schema.pop(name)
    if _NULL in parts:
        schema["nullable"] = True
    kept = [part for part in parts if part != _NULL and (name != "allOf" or "$ref" in part)]
    if kept:
        schema[name] = [_schema(part) for part in kept]


router = APIRouter(include_in_schema=False, route_class=ScopedRoute)
_OFFERED = (JSON, media_type(OPENAPI))


@router.get("/openapi.json")
@needs(Scope.READ)
def description(request: Request) -> Response:
    """Return the description, under the type of OpenAPI to those who prefer that."""
    accepted = negotiated(request.headers.get("accept", "*/*"), _OFFERED)
    answer = served(PageFile(_text(request.app.openapi()), JSON if accepted == JSON else OPENAPI), request)
    answer.headers.add_vary_header("Accept")
    return answer


@router.get("/openapi-3.0.json")
@needs(Scope.READ)
def description_30(request: Request) -> Response:
    """Return the description in OpenAPI 3.0."""
    return served(PageFile(_text(in_version_30(request.app.openapi())), OPENAPI_30), request)


def _text(document: dict[str, Any]) -> bytes:
    return json.dumps(document, ensure_ascii=False, allow_nan=False).encode()
