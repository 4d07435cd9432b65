"""Fields of the boundary made from the fields that a library declares.

A library declares a field (`Declared`: kind, SI unit, bound, description, example) on its dataclass. The
*boundary* is what users write: case files and requests. A field there has the unit in its name, its bounds
and default in that unit, and the description as text. A *part* is a field that is itself a dataclass.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass, fields, replace
from functools import cache
from typing import Annotated, Any, Literal, TypeVar, cast

from pydantic import Field, create_model

from bounds import Choice, Declared, Interval, Kind, Unit, declarations
from fe_contact.flank.flank_grid import FlankGrid
from lineofaction.gearbox.schemas import flank_grid
from lineofaction.gearbox.schemas.model import BoundaryModel, Listed
from lineofaction.gearbox.units import BY_SUFFIX, as_typed, suffix_of

Fields = Mapping[str, tuple[Any, Any]]
Model = TypeVar("Model", bound=BoundaryModel)
_MODELS: Mapping[type, Any] = {FlankGrid: flank_grid.FlankGridInput}
"""Models of the parts whose fields are lists; those of other parts are made from their declarations."""
_EXAMPLES: Mapping[type, Any] = {FlankGrid: flank_grid.EXAMPLE}
"""Examples of these parts."""


@dataclass(frozen=True)
class Figure:
    """A declared number, switch or choice as the boundary has it."""

    name: str
    """Name of the field in the library."""
    what: Declared
    """Declaration of the field."""
    default: Any
    """Default in SI; `MISSING`: a value is required; None: the field may be left out."""
    marked: bool = True
    """Whether the schema of the field states kind and direction (``x-kind``, ``x-along``)."""

    @property
    def field(self) -> str:
        """The field of the boundary: the name with its unit."""
        return f"{self.name}{suffix_of(self.what)}"

    @property
    def unit(self) -> Unit:
        """The unit of the boundary."""
        return BY_SUFFIX.get(suffix_of(self.what), Unit())

    @property
    def label(self) -> str:
        """The name in words."""
        return self.name.replace("_", " ")

    @property
    def limits(self) -> Interval:
        """The range in the unit of the boundary; without ends for a choice of names."""
        bound = self.what.bound
        if not isinstance(bound, Interval):
            return Interval()
        number = int if self.what.kind is Kind.COUNT else float
        ends = {name: getattr(bound, name) for name in ("gt", "ge", "lt", "le")}
        return Interval(
            **{name: None if end is None else self.boundary_value(number(end)) for name, end in ends.items()}
        )

    @property
    def accepted(self) -> Any:
        """The type with its bounds."""
        if isinstance(self.what.bound, Choice):
            return Literal[self.what.bound.names]
        if self.what.kind is Kind.SWITCH:
            return bool
        plain: Any = int if self.what.kind is Kind.COUNT else float
        number = Annotated[plain, *self.limits]
        return number | None if self.default is None else number

    def boundary_value(self, value: Any) -> Any:
        """Return a value in SI in the unit of the boundary, without the noise of the conversion."""
        return as_typed(value, self.unit.factor) if isinstance(value, float) else value

    def with_unit(self, text: str) -> str:
        """Return a text with the unit at its mark ``{unit}``, or else before the first semicolon."""
        unit = self.unit.name or self.what.unit
        if "{unit}" in text:
            return text.replace("{unit}", unit)
        head, semicolon, rest = text.partition(";")
        return f"{head}, in {unit}{semicolon}{rest}" if unit else text

    def as_field(self) -> tuple[Any, Any]:
        """Return the type and the field of a model, as `pydantic.create_model` takes them."""
        along = [direction.name.lower() for direction in self.what.along if direction.name]
        extra: Any = {"x-kind": self.what.kind.value, "x-along": along}
        field = Field(
            default=... if self.default is MISSING else self.boundary_value(self.default),
            description=self.with_unit(self.what.description),
            examples=[self.boundary_value(self.what.example)],
            json_schema_extra=extra if self.marked else None,
            # a field of a later version is left out at its default, so that older cases keep their hash
            exclude_if=self._is_default if self.what.omit_default else None,
        )
        return self.accepted, field

    def _is_default(self, value: Any) -> bool:
        return bool(value == self.boundary_value(self.default))


def figures(kind: type[Any], *kinds: Kind) -> tuple[Figure, ...]:
    """Return the figures of a dataclass: of the `kinds` given, or of all kinds but surfaces and parts."""
    defaults = {entry.name: entry.default for entry in fields(kind)}
    return tuple(
        Figure(name, fact, defaults[name])
        for name, fact in declarations(kind).items()
        if fact.kind not in (Kind.SURFACE, Kind.PART, Kind.PARTS) and (not kinds or fact.kind in kinds)
    )


def declared_in(kind: type[Any], *, required: bool = False, marked: bool = True) -> Fields:
    """Return the declared fields of a dataclass as fields of a model.

    With `required` no figure has a default; `marked` is that of `Figure`.
    """
    declared = (replace(figure, marked=marked) for figure in figures(kind))
    declared = (replace(figure, default=MISSING) if required else figure for figure in declared)
    return {**as_fields(declared), **parts_in(parts_of(kind))}


def as_fields(declared: Iterable[Figure]) -> Fields:
    """Return figures as fields of a model."""
    return {figure.field: figure.as_field() for figure in declared}


def parts_of(kind: type[Any]) -> Mapping[str, Declared]:
    """Return the declared parts of a dataclass by name."""
    return {name: fact for name, fact in declarations(kind).items() if fact.part is not None}


def parts_in(parts: Mapping[str, Declared]) -> Fields:
    """Return parts as fields of a model, tables that may be left out, or lists of them."""
    return {name: _part_field(fact, fact.part) for name, fact in parts.items() if fact.part is not None}


def _part_field(fact: Declared, part: type) -> tuple[Any, Any]:
    example = _EXAMPLES.get(part) or {
        figure.field: figure.boundary_value(figure.what.example) for figure in figures(part)
    }
    several = fact.kind is Kind.PARTS
    field = Field(
        default=() if several else None,
        max_length=fact.maximum if several else None,
        description=fact.description,
        examples=[[example] if several else example],
        exclude_if=operator.not_ if fact.omit_default else None,
    )
    model = _MODELS.get(part) or _model_of(part)
    return (cast("Any", Listed)[model] if several else model | None), field


@cache
def _model_of(part: Any) -> Any:
    name, doc = f"{part.__name__}Input", str(part.__doc__).partition("\n")[0]
    members: Any = declared_in(part)
    model = create_model(name, __base__=BoundaryModel, __module__=__name__, __doc__=doc, **members)
    globals()[name] = model  # pickle finds a class by its name in its module
    return model


def with_fields(further: Fields) -> Callable[[type[Model]], type[Model]]:
    """Return a decorator that adds fields, as (type, field) by name, to a model."""

    def added(model: type[Model]) -> type[Model]:
        members: Any = dict(further)
        return create_model(
            model.__name__, __base__=model, __module__=model.__module__, __doc__=model.__doc__, **members
        )

    return added
