"""A model from REXS's JSON form (``.rexsj``)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from lineofaction.gearbox.rexs.json_tree import Table, value_of
from lineofaction.gearbox.rexs.kinds import KINDS, entry_kind
from lineofaction.gearbox.rexs.model import (
    Attribute,
    Component,
    LoadCase,
    LoadSpectrum,
    Model,
    Reference,
    Relation,
    Scalar,
    Value,
)
from lineofaction.gearbox.rexs.refusal import refused
from lineofaction.gearbox.rexs.values import decoded, rows_of

_TYPES: dict[str, tuple[type, ...]] = {
    "floating_point": (float, int),
    "integer": (int,),
    "reference_component": (int,),
    "boolean": (bool,),
}
_TEXT = (str,)
_CODED = "_coded"
_OWN = ("id", "unit", "origin")


def read_json(data: bytes) -> Model:
    """Return the model of a JSON text.

    Raises
    ------
    BadInput
        It is no JSON that may be read, or no REXS.
    """
    model = Table.of(Table.of(value_of(data), "file").fields.get("model"), "model")
    components = tuple(_component(part, {}) for part in model.tables("components"))
    types = {component.id: component.type for component in components}
    known = ("version", "applicationId", "applicationVersion", "date", "applicationLanguage")
    return Model(
        version=model.text("version"),
        application=model.text("applicationId"),
        application_version=model.text("applicationVersion"),
        date=model.text("date"),
        relations=tuple(map(_relation, model.tables("relations"))),
        components=components,
        spectra=_spectra(model, types),
        language=model.optional_text("applicationLanguage"),
        extra=model.extra(*known, "relations", "components", "load_spectrum", "accumulation"),
    )


def _relation(table: Table) -> Relation:
    refs = tuple(
        Reference(
            ref.number("id"), ref.text("role"), ref.optional_text("hint"), ref.extra("id", "role", "hint")
        )
        for ref in table.tables("refs")
    )
    order = table.number("order") if table.fields.get("order") is not None else None
    return Relation(
        table.number("id"), table.text("type"), refs, order, table.extra("id", "type", "refs", "order")
    )


def _component(table: Table, types: dict[int, str]) -> Component:
    """Return a component; one of a load case may leave its type to the component of its id."""
    number = table.number("id")
    named = table.optional_text("type") or types.get(number)
    return Component(
        id=number,
        type=table.text("type") if named is None else named,
        attributes=tuple(map(_attribute, table.tables("attributes"))),
        name=table.optional_text("name"),
        extra=table.extra("id", "type", "name", "attributes"),
    )


def _spectra(model: Table, types: dict[int, str]) -> tuple[LoadSpectrum, ...]:
    """Return the load spectrum, if there is one, with its accumulation, which stands beside it."""
    if model.fields.get("load_spectrum") is None:
        if "accumulation" in model.fields:
            raise refused("model.accumulation", "an accumulation", "beside a load spectrum")
        return ()
    table = Table.of(model.fields["load_spectrum"], "model.load_spectrum")
    cases = tuple(
        LoadCase(
            case.number("id"),
            tuple(_component(part, types) for part in case.tables("components")),
            case.extra("id", "components"),
        )
        for case in table.tables("load_cases", needed=False)
    )
    spectrum = LoadSpectrum(table.number("id"), cases, extra=table.extra("id", "load_cases"))
    if model.fields.get("accumulation") is None:
        return (spectrum,)
    whole = Table.of(model.fields["accumulation"], "model.accumulation")
    return (
        replace(spectrum, accumulation=tuple(_component(part, types) for part in whole.tables("components"))),
    )


def _attribute(table: Table) -> Attribute:
    name = table.text("id")
    kinds = [field for field in table.fields if _is_kind(field)]
    if len(kinds) != 1:
        raise refused(table.place, ", ".join(kinds) or None, "one value of a type of REXS")
    place = f"{table.place}, {name}"
    coded = kinds[0].endswith(_CODED)
    kind = kinds[0].removesuffix(_CODED)
    plain = table.fields[kinds[0]]
    code = Table.of(plain, place).text("code") if coded else None
    value = _decoded(kind, Table.of(plain, place)) if coded else _value(kind, plain, place)
    extra = table.extra(*_OWN, kinds[0])
    return Attribute(
        name, kind, value, table.optional_text("unit"), code, table.optional_text("origin"), extra
    )


def _is_kind(field: str) -> bool:
    return field not in _OWN and entry_kind(field.removesuffix(_CODED)) in KINDS


def _value(kind: str, plain: Any, place: str) -> Value:
    entry = entry_kind(kind)
    if plain is None or (isinstance(plain, str) and not plain.strip()):
        return None
    if kind == entry:
        return _scalar(entry, plain, place)
    if kind.endswith("_array"):
        return tuple(_scalar(entry, part, place) for part in _list(plain, place))
    return tuple(
        tuple(_scalar(entry, part, place) for part in _list(row, place)) for row in _list(plain, place)
    )


def _decoded(kind: str, body: Table) -> Value:
    """Return the value of an array or a matrix in base64."""
    code = body.text("code")
    if entry_kind(kind) != ("integer" if code == "int32" else "floating_point") or kind == entry_kind(kind):
        raise refused(body.place, code, f"a code of {kind}")
    values = decoded(code, body.text("value"), body.place)
    if kind.endswith("_matrix"):
        return rows_of(values, body.number("rows"), body.number("columns"), body.place)
    return values


def _scalar(kind: str, plain: Any, place: str) -> Scalar:
    """Return a value of a scalar kind; a floating point may be written as an integer."""
    types: Any = _TYPES.get(kind, _TEXT)
    if not isinstance(plain, types) or (isinstance(plain, bool) and bool not in types):
        raise refused(
            place, plain if isinstance(plain, (str, int, float)) else type(plain).__name__, f"of type {kind}"
        )
    value: Scalar = float(plain) if kind == "floating_point" else plain
    if isinstance(value, float) and not math.isfinite(value):
        raise refused(place, str(value), "a finite number")
    return value


def _list(plain: Any, place: str) -> list[Any]:
    if not isinstance(plain, list):
        raise refused(place, type(plain).__name__, "a list")
    return plain
