"""Rules over several fields of a table, as JSON Schema states them; validators of the models enforce them."""

from __future__ import annotations

from lineofaction.gearbox.schemas.model import _ABSENT, _NOT_NULL, Json


def all_of(*rules: Json) -> Json:
    """Return the addition to a model's schema (``json_schema_extra``) by which all rules hold."""
    return {"allOf": list(rules)}


def exactly_one_of(*names: str) -> Json:
    """Return the rule that one of some fields is given."""
    return {"oneOf": [_with(name, *names) for name in names]}


def at_most_one_of(*names: str) -> Json:
    """Return the rule that none or one of some fields is given."""
    return {"oneOf": [absent(*names), *(_with(name, *names) for name in names)]}


def at_least_one_of(*names: str) -> Json:
    """Return the rule that one or more of some fields are given."""
    return {"anyOf": [required(name) for name in names]}


def values_or_factor(*names: str) -> Json:
    """Return the rule that one or more of some fields are given, or a factor on all of them."""
    of_factor = both(required("factor"), absent(*names))
    return {"oneOf": [of_factor, at_least_one_of(*names) | absent("factor")]}


def required(*names: str) -> Json:
    """Return the schema of tables that have some fields."""
    return {"required": list(names), "properties": dict.fromkeys(names, _NOT_NULL)}


def absent(*names: str) -> Json:
    """Return the schema of tables without some fields."""
    return {"properties": dict.fromkeys(names, _ABSENT)}


def both(first: Json, second: Json) -> Json:
    """Return the schema of tables for which two schemas hold."""
    properties = first["properties"] | second["properties"]
    return {"required": [*first.get("required", ()), *second.get("required", ())], "properties": properties}


def _with(name: str, *names: str) -> Json:
    return both(required(name), absent(*(other for other in names if other != name)))
