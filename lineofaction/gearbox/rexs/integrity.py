"""Checks of a model: ids are unique, references lead to components, no component holds itself."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.rexs.model import Model

_WHOLE, _PART = "assembly", "part"
_ASSEMBLIES = ("assembly", "ordered_assembly")
_MOST_FAULTS = 20


def check(model: Model) -> None:
    """Check the model's references.

    Raises
    ------
    BadInput
        With a fault for each id given twice, reference to no component, and component that holds itself; at
        most 20.
    """
    faults = [*_repeated(model), *_dangling(model), *_cycles(model)]
    if faults:
        raise BadInput(faults[:_MOST_FAULTS])


def _repeated(model: Model) -> Iterator[Fault]:
    """Yield the ids that are given twice."""
    lists = {
        "component": [component.id for component in model.components],
        "relation": [relation.id for relation in model.relations],
        "load spectrum": [spectrum.id for spectrum in model.spectra],
    }
    for spectrum in model.spectra:
        lists[f"load spectrum {spectrum.id}, load case"] = [case.id for case in spectrum.cases]
    for place, ids in lists.items():
        yield from (
            Fault(place, number, "an id given once") for number, count in Counter(ids).items() if count > 1
        )


def _dangling(model: Model) -> Iterator[Fault]:
    """Yield the references to components that do not exist."""
    known = {component.id for component in model.components}
    bound = "the id of a component"
    for relation in model.relations:
        yield from (
            Fault(f"relation {relation.id}, {ref.role}", ref.id, bound)
            for ref in relation.refs
            if ref.id not in known
        )
    for place, part in model.all_components():
        if part.id not in known:
            yield Fault(place, part.id, bound)
        for attribute in part.attributes:
            if attribute.kind == "reference_component" and attribute.value not in {None, *known}:
                yield Fault(f"{place}, {attribute.id}", attribute.value, bound)


def _cycles(model: Model) -> Iterator[Fault]:
    """Yield the components that hold themselves, directly or by others, in order of their ids.

    Components whose parts are all settled are settled; what never settles is on a cycle or holds one.
    """
    parts: dict[int, set[int]] = {}
    for relation in model.relations:
        whole, part = relation.of_role(_WHOLE), relation.of_role(_PART)
        if relation.type in _ASSEMBLIES and whole is not None and part is not None:
            parts.setdefault(whole, set()).add(part)
    holders: dict[int, set[int]] = {}
    for whole, inner in parts.items():
        for part in inner:
            holders.setdefault(part, set()).add(whole)
    open_parts = {whole: len(inner) for whole, inner in parts.items()}
    settled = [part for part in holders if part not in parts]
    while settled:
        for whole in holders.get(settled.pop(), ()):
            open_parts[whole] -= 1
            if not open_parts[whole]:
                settled.append(whole)
    for number in sorted(whole for whole, count in open_parts.items() if count):
        yield Fault(f"component {number}", number, "no part of itself, nor whole of one that is")
