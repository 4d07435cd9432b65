"""The account of an import: the fate of every component and attribute of a file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, get_args

from lineofaction.gearbox.from_rexs.assumptions import ASSUMED, FORMER, attribute_text
from lineofaction.gearbox.rexs.model import Attribute, Component, Model

Fate = Literal["taken", "assumed", "derived", "defaulted", "ignored", "refused"]
"""Fates of a component or value: taken as it is; assumed by the caller over the file; derived from other
values; defaulted, because no usable value is stated; ignored, because no analysis uses it; refused with a
reason, because the unit has it and the scene cannot."""
FATES: tuple[Fate, ...] = get_args(Fate)

UNUSED = "no analysis uses it"


@dataclass(frozen=True)
class Line:
    """Fate of a component, of an attribute of it, or of a value that it lacks."""

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
    """Name of the field in the case or scene, the formula that the value follows from, or the reason."""
    line: int | None = None
    """Line of the component in an XML file, counted from 1."""


class Account:
    """The account of one model. A reader of a value states the fate of the value; the last statement counts.

    `model` has the newest version of REXS.
    """

    def __init__(self, model: Model) -> None:
        self._places = {id(part): location for location, part in model.all_components()}
        self._parts = {id(part): part for _, part in model.all_components()}
        self._said: dict[int, dict[str, tuple[Fate, str]]] = {number: {} for number in self._parts}

    def location(self, component: Component) -> str:
        """Return the location of a component: its id, and its load case."""
        return self._places[id(component)]

    def say(self, component: Component, item: str, fate: Fate, text: str) -> None:
        """State the fate of an attribute that a component has or lacks; `item` "" is the component."""
        self._said[id(component)][item] = (fate, text)

    def has_entry(self, component: Component) -> bool:
        """Return whether the account has a line on the component itself."""
        return "" in self._said[id(component)]

    def lines(self) -> tuple[Line, ...]:
        """Return a line for each component, each attribute, and each value stated that the file lacks.

        In the order of the file. An attribute of which nothing was said is ignored; a component is taken if
        anything of it is taken or derived, and ignored otherwise.
        """
        return tuple(line for part in self._parts.values() for line in self._lines(part))

    def _lines(self, part: Component) -> Iterator[Line]:
        fates = dict(self._said[id(part)])
        component_entry = fates.pop("", None)
        for attribute in part.attributes:
            fate, text = fates.setdefault(attribute.id, ("ignored", UNUSED))
            if attribute.origin == ASSUMED and fate in ("taken", "ignored"):
                fates[attribute.id] = _assumed(attribute, fate, text)
        used = any(fate in ("taken", "derived", "assumed") for fate, _ in fates.values())
        component_entry = component_entry or (("taken", "") if used else ("ignored", UNUSED))
        location, name = self.location(part), part.name or ""
        for item, (fate, text) in {"": component_entry, **fates}.items():
            yield Line(location, part.id, part.type, name, item, fate, text, part.line)


def _assumed(attribute: Attribute, fate: Fate, text: str) -> tuple[Fate, str]:
    """Return the fate of an assumed value; a value that nothing reads is refused."""
    if fate == "ignored":
        return "refused", f"assumed to be {attribute_text(attribute)}, and {text}"
    return "assumed", f"{attribute_text(attribute)} instead of {dict(attribute.extra)[FORMER]}: {text}"
