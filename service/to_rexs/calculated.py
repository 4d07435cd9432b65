"""Calculated attributes in a REXS document."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from service.problems import BadInput
from service.rexs import Attribute, Component, Document

CALCULATED = "calculated"
"""Origin of what this program writes (REXS, since 1.5)."""


def calculated(name: str, value: float | Sequence[float], unit: str) -> Attribute:
    """Return an attribute of a number or an array in `unit`, a unit of REXS."""
    if isinstance(value, Sequence):
        return Attribute(name, "floating_point_array", tuple(map(float, value)), unit, origin=CALCULATED)
    return Attribute(name, "floating_point", float(value), unit, origin=CALCULATED)


def with_calculated(document: Document, results: Mapping[int, Iterable[Attribute]]) -> Document:
    """Return a document with results on its components; everything else stays as it is.

    A result takes the place of an attribute of its name, another program's too.

    Parameters
    ----------
    document : Document
    results : mapping of int to iterable of Attribute
        By id of the component.

    Raises
    ------
    BadInput
        The document has no component of an id.
    """
    model = document.model
    known = {component.id for component in model.components}
    for number in results:
        if number not in known:
            raise BadInput.of("results", number, "the id of a component of the document")
    components = tuple(_with(component, results.get(component.id, ())) for component in model.components)
    return replace(document, model=replace(model, components=components))


def _with(component: Component, results: Iterable[Attribute]) -> Component:
    """Return a component with results, after what else it has."""
    new = tuple(results)
    names = {attribute.id for attribute in new}
    kept = tuple(attribute for attribute in component.attributes if attribute.id not in names)
    return replace(component, attributes=(*kept, *new))
