"""Calculated attributes in a REXS document."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Document

CALCULATED = "calculated"
"""Origin of attributes that this program writes (REXS, since 1.5)."""

Results = Mapping[int, Iterable[Attribute]]
"""Calculated attributes by id of the component."""


def calculated(name: str, value: float | Sequence[float], unit: str) -> Attribute:
    """Return an attribute of a number or an array in `unit`, a unit of REXS."""
    if isinstance(value, Sequence):
        return Attribute(name, "floating_point_array", tuple(map(float, value)), unit, origin=CALCULATED)
    return Attribute(name, "floating_point", float(value), unit, origin=CALCULATED)


def with_results(document: Document, results: Results) -> Document:
    """Return a document with results on its components; everything else stays as it is.

    A result takes the place of an attribute of its name, another program's too.
    """
    model = document.model
    _refuse_unknown(document, results)
    components = tuple(_with(component, results.get(component.id, ())) for component in model.components)
    return replace(document, model=replace(model, components=components))


def with_case_results(document: Document, number: int, results: Results) -> Document:
    """Return a document with results in a load case of its first spectrum; see `with_results`.

    Without a spectrum the results are those of the components themselves. `number` is the place of the load
    case in the spectrum, from 1.
    """
    model = document.model
    if not model.spectra:
        return with_results(document, results)
    _refuse_unknown(document, results)
    first = model.spectra[0]
    cases = list(first.cases)
    case = cases[number - 1]
    absent = results.keys() - {component.id for component in case.components}
    further = (Component(part.id, part.type) for part in model.components if part.id in absent)
    components = tuple(_with(part, results.get(part.id, ())) for part in (*case.components, *further))
    cases[number - 1] = replace(case, components=components)
    spectra = (replace(first, cases=tuple(cases)), *model.spectra[1:])
    return replace(document, model=replace(model, spectra=spectra))


def _refuse_unknown(document: Document, results: Results) -> None:
    known = {component.id for component in document.model.components}
    for number in results:
        if number not in known:
            raise BadInput.of("results", number, "the id of a component of the document")


def _with(component: Component, results: Iterable[Attribute]) -> Component:
    """Return a component with results appended to its attributes."""
    new = tuple(results)
    names = {attribute.id for attribute in new}
    others = tuple(attribute for attribute in component.attributes if attribute.id not in names)
    return replace(component, attributes=(*others, *new))
