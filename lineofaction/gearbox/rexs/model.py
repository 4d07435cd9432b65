"""A REXS model as its file has it: names, values, units and order of REXS (FVA, versions 1.0 to 2.0.0)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

Scalar = float | int | bool | str
Array = tuple[Scalar, ...]
Value = Scalar | Array | tuple[Array, ...] | None
"""A scalar, an array, a matrix by rows (an array of arrays), or None where the file gives no value."""

Extra = tuple[tuple[str, str], ...]
"""Name and text of the fields of an element that REXS does not define, in their order. They are written back.
"""


@dataclass(frozen=True)
class Attribute:
    """A value of a component."""

    id: str
    """Name in REXS, e.g. ``"normal_module"``; names that a program adds begin with ``custom_``."""
    kind: str
    """Type of the value as the JSON form writes it: ``floating_point``, ``integer``, ``boolean``, ``enum``,
    ``string``, ``reference_component``, ``file_reference``; with ``_array`` or ``_matrix``;
    ``array_of_integer_arrays``.
    """
    value: Value
    """Value in `unit`; None if the file has none, or a blank text."""
    unit: str | None = None
    """Unit as the file writes it; None if the file states none."""
    code: str | None = None
    """Number type of an array that the file codes in base64: ``float32``, ``float64`` or ``int32``."""
    origin: str | None = None
    """Origin of the value (since version 1.5), e.g. ``"calculated"``."""
    extra: Extra = ()


@dataclass(frozen=True)
class Component:
    """A part of the gear unit, or the values of a part under a load case.

    `line` is that of its element in an XML file, from 1; None in other forms. Components that differ in it
    alone are equal.
    """

    id: int
    type: str
    attributes: tuple[Attribute, ...] = ()
    name: str | None = None
    extra: Extra = ()
    line: int | None = field(default=None, compare=False)

    def attribute(self, name: str) -> Attribute | None:
        """Return the first attribute of a name, None if there is none."""
        return next((attribute for attribute in self.attributes if attribute.id == name), None)


@dataclass(frozen=True)
class Reference:
    """A component in a relation, by its role there."""

    id: int
    role: str
    hint: str | None = None
    extra: Extra = ()


@dataclass(frozen=True)
class Relation:
    """A relation of components by their roles; `order` counts parts of an ordered assembly from 1."""

    id: int
    type: str
    refs: tuple[Reference, ...]
    order: int | None = None
    extra: Extra = ()

    def of_role(self, role: str) -> int | None:
        """Return the id of the component in a role, None if no component has it."""
        return next((ref.id for ref in self.refs if ref.role == role), None)


@dataclass(frozen=True)
class LoadCase:
    """Values of components under one load case."""

    id: int
    components: tuple[Component, ...] = ()
    extra: Extra = ()


@dataclass(frozen=True)
class LoadSpectrum:
    """Load cases, and results over all of them (`accumulation`)."""

    id: int
    cases: tuple[LoadCase, ...]
    accumulation: tuple[Component, ...] | None = None
    extra: Extra = ()


@dataclass(frozen=True)
class Model:
    """A gear unit."""

    version: str
    """Version of REXS as the file writes it: ``"1.4"``, ``"2.0.0"``."""
    application: str
    application_version: str
    date: str
    """`application`, `application_version`, `date`: The writing program and the time of writing."""
    relations: tuple[Relation, ...] = ()
    components: tuple[Component, ...] = ()
    spectra: tuple[LoadSpectrum, ...] = ()
    language: str | None = None
    extra: Extra = ()

    def component(self, number: int) -> Component | None:
        """Return the component of an id, None if there is none."""
        return next((component for component in self.components if component.id == number), None)

    def mapped(self, change: Callable[[str, Component], Component]) -> Model:
        """Return the model with each component replaced by ``change(place, component)``, in load cases too.

        The place is text on the position in the file, as `all_components` yields it.
        """
        places = (location for location, _ in self.all_components())

        def changed(parts: Iterable[Component]) -> tuple[Component, ...]:
            return tuple(change(next(places), part) for part in parts)

        components, spectra = changed(self.components), []
        for spectrum in self.spectra:
            cases = tuple(replace(case, components=changed(case.components)) for case in spectrum.cases)
            accumulation = None if spectrum.accumulation is None else changed(spectrum.accumulation)
            spectra.append(replace(spectrum, cases=cases, accumulation=accumulation))
        return replace(self, components=components, spectra=tuple(spectra))

    def all_components(self) -> Iterator[tuple[str, Component]]:
        """Yield the components with their places in the file, including components of load cases."""
        yield from ((f"component {component.id}", component) for component in self.components)
        for spectrum in self.spectra:
            for case in spectrum.cases:
                location = f"load spectrum {spectrum.id}, load case {case.id}"
                yield from ((f"{location}, component {part.id}", part) for part in case.components)
            location = f"load spectrum {spectrum.id}, accumulation"
            yield from ((f"{location}, component {part.id}", part) for part in spectrum.accumulation or ())


@dataclass(frozen=True)
class Document:
    """A model and the other files of its archive, by their names."""

    model: Model
    files: Mapping[str, bytes] = field(default_factory=dict)
