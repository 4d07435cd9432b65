"""What a reading left out, changed or assumed, said once for reports and answers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal, get_args

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Model
from lineofaction.gearbox.rexs.values import entry_kind, kind_of, scalar_of, texts_of
from lineofaction.gearbox.rexs.vocabulary import listed_unit

# Assumptions: values of attributes that a caller sets over those of the file before it is opened.


ASSUMED, FORMER = "assumed", "former"
"""Origin of an attribute that is assumed, and the field in which it keeps what the file says."""
_FORM = re.compile(r"(\d{1,18})\.([A-Za-z]\w*)=(.+)")
_EXAMPLE = "COMPONENT.ATTRIBUTE=VALUE, as in 14.helix_angle_reference_diameter=-12"
_PLACE = re.compile(r"component (\d+), (\w+)$")
"""The end of a field that names an attribute of a component."""
_SEVERAL = re.compile(r"[,\s]+")


@dataclass(frozen=True)
class Assumption:
    """A value of an attribute."""

    component: int
    """Id of the component."""
    attribute: str
    """Its name in the newest version of REXS."""
    value: str
    """As XML writes it, in the unit of the file, else in that of REXS; numbers of an array apart by commas.
    """

    @classmethod
    def of(cls, text: str) -> Assumption:
        """Return what ``COMPONENT.ATTRIBUTE=VALUE`` says.

        Raises `BadInput`: it has another form.
        """
        match = _FORM.fullmatch(text.strip())
        if match is None:
            raise BadInput.of("assume", text, f"of the form {_EXAMPLE}")
        return cls(int(match[1]), match[2], match[3].strip())


def assumed(model: Model, assumptions: Iterable[Assumption]) -> Model:
    """Return a model of the newest version with the assumed values, in load cases that state them too."""
    for assumption in assumptions:
        if model.component(assumption.component) is None:
            bound = "the id of a component of the file"
            raise BadInput.of("assume", assumption.component, bound, f"The form is {_EXAMPLE}.")
        model = _with(model, assumption)
    return model


def _shown(attribute: Attribute) -> str:
    unit = "" if attribute.unit in (None, "none", "-") else f" {attribute.unit}"
    return ", ".join(texts_of(attribute.value)) + unit


def mend(error: BadInput) -> str:
    """Return the assumptions that replace the values at fault, empty where none is that of a component."""
    places = [_PLACE.search(fault.field) for fault in error.faults]
    known = [place for place in places if place is not None and listed_unit(place[2]) is not None]
    options = ", ".join(f"--assume {place[1]}.{place[2]}=VALUE" for place in known)
    return f" Or open it with {options}." if options else ""


def _with(model: Model, assumption: Assumption) -> Model:
    def changed(place: str, part: Component) -> Component:
        former = part.attribute(assumption.attribute)
        is_own, in_case = place == f"component {part.id}", "load case" in place and former is not None
        if part.id != assumption.component or not (is_own or in_case):
            return part
        kept = tuple(entry for entry in part.attributes if entry.id != assumption.attribute)
        return replace(part, attributes=(*kept, _attribute(assumption, former)))

    return model.mapped(changed)


def _attribute(assumption: Assumption, former: Attribute | None) -> Attribute:
    """Return the attribute, of the file's kind and unit where it has them."""
    name, place = assumption.attribute, f"assume, {assumption.component}.{assumption.attribute}"
    several = "," in assumption.value
    texts = _SEVERAL.split(assumption.value.strip("[] ")) if several else [assumption.value]
    kind = kind_of(name, texts) if former is None else entry_kind(former.kind)
    values = tuple(scalar_of(kind, text, place) for text in texts)
    before = "no value" if former is None or former.value is None else _shown(former)
    return Attribute(
        name,
        f"{kind}_array" if several else kind,
        values if several else values[0],
        listed_unit(name) if former is None else former.unit,
        origin=ASSUMED,
        extra=((FORMER, before),),
    )


# The account of an import: what became of every component and attribute of a file.


Fate = Literal["taken", "assumed", "derived", "defaulted", "ignored", "refused"]
"""Taken as it is; assumed by the caller over the file; derived from other values; defaulted for want of a
usable one; ignored, since nothing here uses it; refused with a reason: the unit has it, the scene has not."""
FATES: tuple[Fate, ...] = get_args(Fate)

UNUSED = "no analysis uses it"


@dataclass(frozen=True)
class Line:
    """What became of a component, an attribute of it, or a value that it lacks."""

    place: str
    """The component, with its load case."""
    component: int
    """Id of the component."""
    kind: str
    name: str
    """`kind`, `name`: Type and name of the component."""
    item: str
    """The attribute; empty for the component itself."""
    fate: Fate
    words: str
    """Its name here, the formula it follows from, or the reason."""
    line: int | None = None
    """Of the component in an XML file, from 1."""


class Account:
    """The account of one model. Whoever reads a value states what becomes of it; the last word counts.

    `model`: of the newest version.
    """

    def __init__(self, model: Model) -> None:
        self._places = {id(part): place for place, part in model.all_components()}
        self._parts = {id(part): part for _, part in model.all_components()}
        self._said: dict[int, dict[str, tuple[Fate, str]]] = {number: {} for number in self._parts}

    def place(self, component: Component) -> str:
        """Return where a component stands: its id, and its load case."""
        return self._places[id(component)]

    def say(self, component: Component, item: str, fate: Fate, words: str) -> None:
        """State what becomes of an attribute that a component has or lacks; `item` "" is the component."""
        self._said[id(component)][item] = (fate, words)

    def is_stated(self, component: Component) -> bool:
        """Return whether something was said of the component itself."""
        return "" in self._said[id(component)]

    def lines(self) -> tuple[Line, ...]:
        """Return a line for each component, each attribute, and each value stated that the file lacks.

        In the order of the file. An attribute of which nothing was said is ignored; a component is taken if
        anything of it is taken or derived, and ignored otherwise.
        """
        return tuple(line for part in self._parts.values() for line in self._lines(part))

    def _lines(self, part: Component) -> Iterator[Line]:
        said = dict(self._said[id(part)])
        own = said.pop("", None)
        for attribute in part.attributes:
            fate, words = said.setdefault(attribute.id, ("ignored", UNUSED))
            if attribute.origin == ASSUMED and fate in ("taken", "ignored"):
                said[attribute.id] = _assumed(attribute, fate, words)
        used = any(fate in ("taken", "derived", "assumed") for fate, _ in said.values())
        own = own or (("taken", "") if used else ("ignored", UNUSED))
        place, name = self.place(part), part.name or ""
        for item, (fate, words) in {"": own, **said}.items():
            yield Line(place, part.id, part.type, name, item, fate, words, part.line)


def _assumed(attribute: Attribute, fate: Fate, words: str) -> tuple[Fate, str]:
    """Return what became of an assumed value: one that nothing reads is refused."""
    if fate == "ignored":
        return "refused", f"assumed to be {_shown(attribute)}, and {words}"
    return "assumed", f"{_shown(attribute)} instead of {dict(attribute.extra)[FORMER]}: {words}"
