"""Models from the elements of a file and back, alike for the XML and the JSON form."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from lineofaction.gearbox.rexs.model import (
    Attribute,
    Component,
    Extra,
    LoadCase,
    LoadSpectrum,
    Model,
    Reference,
    Relation,
)

MAX_ENTRIES = 300_000
"""Most entries of a file: elements of XML, or values, lists and tables of JSON. 300 000 elements take 170 MB
of memory. A longer list of numbers can be written in base64, where it is one entry."""


class Element(ABC):
    """An element as read. To take a field removes it; a field that remains is unknown to REXS and is kept.

    Every method raises `BadInput` with the place in the file where a field or a part is missing or is of
    another type.
    """

    __slots__ = ()
    fields: dict[str, Any]
    line: int | None
    """Line of the element in the file, from 1; None in forms without lines."""

    @abstractmethod
    def text(self, name: str) -> str:
        """Take a text that must be given."""

    @abstractmethod
    def optional_text(self, name: str) -> str | None:
        """Take a text, None where it is not given."""

    @abstractmethod
    def number(self, name: str) -> int:
        """Take an integer that must be given."""

    @abstractmethod
    def optional_number(self, name: str) -> int | None:
        """Take an integer, None where it is not given."""

    @abstractmethod
    def parts(self, name: str) -> Sequence[Element]:
        """Return the inner elements of the kind `name`; none if there are none."""

    @abstractmethod
    def attribute(self) -> Attribute:
        """Return a value of a component."""

    @abstractmethod
    def extra(self) -> Extra:
        """Take all that is left."""

    def type_of(self, inherited: str | None) -> str:
        """Take the type of a component; `inherited` is the type of the model's component of the same id."""
        del inherited
        return self.text("type")

    def component(self, types: Mapping[int, str]) -> Component:
        """Return a component; its type may follow from the types of the model's components."""
        number = self.number("id")
        return Component(
            id=number,
            type=self.type_of(types.get(number)),
            attributes=tuple(part.attribute() for part in self.parts("attribute")),
            name=self.optional_text("name"),
            extra=self.extra(),
            line=self.line,
        )

    def load_case(self, types: Mapping[int, str]) -> LoadCase:
        """Return the values of a load case."""
        number = self.number("id")
        parts = tuple(part.component(types) for part in self.parts("component"))
        return LoadCase(number, parts, self.extra())

    def relation(self) -> Relation:
        """Return a relation with its references."""
        return Relation(
            id=self.number("id"),
            type=self.text("type"),
            refs=tuple(part._reference() for part in self.parts("ref")),
            order=self.optional_number("order"),
            extra=self.extra(),
        )

    def _reference(self) -> Reference:
        return Reference(self.number("id"), self.text("role"), self.optional_text("hint"), self.extra())

    def model(
        self,
        relations: Iterable[Relation],
        components: Iterable[Component],
        spectra: Iterable[LoadSpectrum],
    ) -> Model:
        """Return the model of a root."""
        return Model(
            version=self.text("version"),
            application=self.text("applicationId"),
            application_version=self.text("applicationVersion"),
            date=self.text("date"),
            relations=tuple(relations),
            components=tuple(components),
            spectra=tuple(spectra),
            language=self.optional_text("applicationLanguage"),
            extra=self.extra(),
        )


@dataclass(frozen=True)
class Written:
    """An element to write: fields with a value in their order, and groups of inner elements."""

    name: str
    fields: dict[str, str | int]
    groups: Mapping[str, Sequence[Written | Attribute]] = field(default_factory=dict)


def written(model: Model) -> Written:
    """Return a model as an element to write."""
    fields = {
        "version": model.version,
        "applicationId": model.application,
        "applicationVersion": model.application_version,
        "date": model.date,
        "applicationLanguage": model.language,
    }
    groups = {
        "relations": [_relation(relation) for relation in model.relations],
        "components": [_component(part) for part in model.components],
        "load_spectra": [_spectrum(spectrum) for spectrum in model.spectra],
    }
    return Written("model", _present_fields(fields, model.extra), groups)


def _present_fields(fields: Mapping[str, str | int | None], extra: Extra) -> dict[str, str | int]:
    return {name: value for name, value in fields.items() if value is not None} | dict(extra)


def _attribute_fields(
    part: Relation | Reference | Component | LoadCase | LoadSpectrum, *names: str
) -> dict[str, str | int]:
    return _present_fields({name: getattr(part, name) for name in names}, part.extra)


def _relation(relation: Relation) -> Written:
    refs = [Written("ref", _attribute_fields(ref, "id", "role", "hint")) for ref in relation.refs]
    return Written("relation", _attribute_fields(relation, "id", "type", "order"), {"refs": refs})


def _component(component: Component) -> Written:
    fields = _attribute_fields(component, "id", "type", "name")
    return Written("component", fields, {"attributes": component.attributes})


def _spectrum(spectrum: LoadSpectrum) -> Written:
    cases = [
        Written(
            "load_case", _attribute_fields(case, "id"), {"components": list(map(_component, case.components))}
        )
        for case in spectrum.cases
    ]
    groups: dict[str, list[Written]] = {"load_cases": cases}
    if spectrum.accumulation is not None:
        groups["accumulation"] = list(map(_component, spectrum.accumulation))
    return Written("load_spectrum", _attribute_fields(spectrum, "id"), groups)
