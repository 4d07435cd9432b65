"""Assumptions of a caller about a REXS file: values of attributes that replace values of the file."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Model
from lineofaction.gearbox.rexs.values import entry_kind, kind_of, scalar_of, texts_of
from lineofaction.gearbox.rexs.vocabulary import listed_unit

ASSUMED, FORMER = "assumed", "former"
"""Origin of an assumed attribute, and name of its additional field with the value of the file."""

_FORM = re.compile(r"(\d{1,18})\.([A-Za-z]\w*)=(.+)")

_EXAMPLE = "COMPONENT.ATTRIBUTE=VALUE, as in 14.helix_angle_reference_diameter=-12"

_ATTRIBUTE_FIELD = re.compile(r"component (\d+), (\w+)$")
"""End of the field of a fault that names an attribute of a component."""

_SEPARATOR = re.compile(r"[,\s]+")
"""Separators of the numbers of an array."""


@dataclass(frozen=True)
class Assumption:
    """A value of an attribute that a caller assumes."""

    component: int
    """Id of the component."""
    attribute: str
    """Name of the attribute in the newest version of REXS."""
    value: str
    """Value as text. Its unit is that of the attribute in the file, or the unit of REXS if the file lacks the
    attribute. Commas separate the numbers of an array.
    """

    @classmethod
    def of(cls, text: str) -> Assumption:
        """Return the assumption of the text ``COMPONENT.ATTRIBUTE=VALUE``.

        Raises `BadInput`: it has another form.
        """
        match = _FORM.fullmatch(text.strip())
        if match is None:
            raise BadInput.of("assume", text, f"of the form {_EXAMPLE}")
        return cls(int(match[1]), match[2], match[3].strip())


def assumed(model: Model, assumptions: Iterable[Assumption]) -> Model:
    """Return a model of the newest version of REXS with the assumed values.

    A value replaces that of the component, and those of load cases that state the attribute.
    """
    for assumption in assumptions:
        if model.component(assumption.component) is None:
            bound = "the id of a component of the file"
            raise BadInput.of("assume", assumption.component, bound, f"The form is {_EXAMPLE}.")
        model = _with(model, assumption)
    return model


def attribute_text(attribute: Attribute) -> str:
    """Return the value of an attribute with its unit."""
    unit = "" if attribute.unit in (None, "none", "-") else f" {attribute.unit}"
    return ", ".join(texts_of(attribute.value)) + unit


def mend(error: BadInput) -> str:
    """Return a sentence with the options that replace the values at fault; empty: no fault is of a value."""
    places = [_ATTRIBUTE_FIELD.search(fault.field) for fault in error.faults]
    known = [match for match in places if match is not None and listed_unit(match[2]) is not None]
    options = ", ".join(f"--assume {match[1]}.{match[2]}=VALUE" for match in known)
    return f" Or open it with {options}." if options else ""


def _with(model: Model, assumption: Assumption) -> Model:
    def changed(location: str, part: Component) -> Component:
        former = part.attribute(assumption.attribute)
        is_component = location == f"component {part.id}"
        in_case = "load case" in location and former is not None
        if part.id != assumption.component or not (is_component or in_case):
            return part
        others = tuple(entry for entry in part.attributes if entry.id != assumption.attribute)
        return replace(part, attributes=(*others, _attribute(assumption, former)))

    return model.mapped(changed)


def _attribute(assumption: Assumption, former: Attribute | None) -> Attribute:
    """Return the assumed attribute, with the kind and the unit of the file's attribute if there is one."""
    name, field = assumption.attribute, f"assume, {assumption.component}.{assumption.attribute}"
    several = "," in assumption.value
    texts = _SEPARATOR.split(assumption.value.strip("[] ")) if several else [assumption.value]
    kind = kind_of(name, texts) if former is None else entry_kind(former.kind)
    values = tuple(scalar_of(kind, text, field) for text in texts)
    before = "no value" if former is None or former.value is None else attribute_text(former)
    return Attribute(
        name,
        f"{kind}_array" if several else kind,
        values if several else values[0],
        listed_unit(name) if former is None else former.unit,
        origin=ASSUMED,
        extra=((FORMER, before),),
    )
