"""REXS's JSON form of a model."""

from __future__ import annotations

import json
from typing import Any

from lineofaction.gearbox.rexs.model import Attribute, Component, Model, Relation
from lineofaction.gearbox.rexs.refusal import refused
from lineofaction.gearbox.rexs.values import coded


def json_of(model: Model) -> bytes:
    """Return a model as JSON in UTF-8, the same bytes at every time.

    Raises
    ------
    BadInput
        The model has several load spectra: the form has a place for one.
    """
    if len(model.spectra) > 1:
        raise refused("load_spectrum", f"{len(model.spectra)} spectra", "one in JSON", "Write XML.")
    table = {
        "version": model.version,
        "applicationId": model.application,
        "applicationVersion": model.application_version,
        "date": model.date,
        "applicationLanguage": model.language,
        **dict(model.extra),
        "relations": [_relation(relation) for relation in model.relations],
        "components": [_component(component) for component in model.components],
        **_spectrum(model),
    }
    text = json.dumps({"model": _given(table)}, ensure_ascii=False, indent=1, allow_nan=False)
    return f"{text}\n".encode()


def _relation(relation: Relation) -> dict[str, Any]:
    """Return a relation."""
    refs = [
        _given({"id": ref.id, "role": ref.role, "hint": ref.hint, **dict(ref.extra)}) for ref in relation.refs
    ]
    own = {"id": relation.id, "type": relation.type, "order": relation.order}
    return _given({**own, **dict(relation.extra), "refs": refs})


def _component(component: Component) -> dict[str, Any]:
    """Return a component."""
    own = {"id": component.id, "type": component.type, "name": component.name}
    attributes = [_attribute(attribute) for attribute in component.attributes]
    return _given({**own, **dict(component.extra), "attributes": attributes})


def _spectrum(model: Model) -> dict[str, Any]:
    """Return the load spectrum and its accumulation, as far as there are."""
    tables: dict[str, Any] = {}
    for spectrum in model.spectra:
        cases = [
            {"id": case.id, **dict(case.extra), "components": [_component(part) for part in case.components]}
            for case in spectrum.cases
        ]
        tables["load_spectrum"] = {"id": spectrum.id, **dict(spectrum.extra), "load_cases": cases}
        if spectrum.accumulation is not None:
            tables["accumulation"] = {"components": [_component(part) for part in spectrum.accumulation]}
    return tables


def _attribute(attribute: Attribute) -> dict[str, Any]:
    """Return an attribute; one without a value says null."""
    own = {"id": attribute.id, "unit": attribute.unit, "origin": attribute.origin, **dict(attribute.extra)}
    if attribute.code is None or attribute.value is None:
        return {**_given(own), attribute.kind: attribute.value}
    return {**_given(own), f"{attribute.kind}_coded": _coded(attribute, attribute.code)}


def _coded(attribute: Attribute, code: str) -> dict[str, Any]:
    """Return an array or a matrix in base64."""
    value: Any = attribute.value
    if not attribute.kind.endswith("_matrix"):
        return {"code": code, "value": coded(code, value)}
    numbers = tuple(number for row in value for number in row)
    size = {"rows": len(value), "columns": len(value[0]) if value else 0}
    return {"code": code, "value": coded(code, numbers), **size}


def _given(table: dict[str, Any]) -> dict[str, Any]:
    """Return the fields that have a value."""
    return {name: value for name, value in table.items() if value is not None}
