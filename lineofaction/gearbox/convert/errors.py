"""Errors of the libraries as the boundary shows them: its field names, its units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import BaseModel

from bounds import Reader, RefusedValue, Unit
from dynamics.errors import DynamicsError
from dynamics.errors import InputError as DynamicsInputError
from fe_contact.errors import FeContactError, InfeasibleGeometry
from fe_contact.errors import InputError as ContactInputError
from host import Unavailable, missing_extra
from lineofaction.gearbox.convert.boundary_names import boundary_name, case_field, scene_field
from lineofaction.gearbox.problems import BadInput, Fault, JobFailed, ServiceError
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.faults import field_remedy
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import BY_SUFFIX, MM, as_typed, factor, unit_of
from model_studies.workers import WorkersLost

_SUFFIXES_IN_TEXT = ("_n_per_mm3", "_gpa", "_deg", "_rpm")
"""Units in which a message writes values of other fields, by the suffix of a field."""


@dataclass(frozen=True)
class _CaseReader(Reader):
    """The words for a reader who wrote a case file: its field names and units."""

    knows_si: ClassVar[bool] = False
    model: ClassVar[type[BaseModel]] = Case

    @property
    def name(self) -> str:
        """The case file's name of the field."""
        return case_field(self.field)

    def field_unit(self, unit: str) -> Unit:
        """Return the unit of the field by its name; without a symbol where `unit` is empty."""
        of_name = unit_of(self.name) or Unit(unit)
        return of_name if unit else Unit("", of_name.factor)

    def unit(self, value: float, unit: str) -> Unit:
        """Return the unit in which a message writes a value: the field's; for lengths um or mm by size."""
        of_name = unit_of(self.name)
        if of_name and of_name.si == unit != "m":
            return of_name
        if unit == "m":
            return BY_SUFFIX["_um" if 0.0 < abs(value) < 0.1 * MM else "_mm"]
        return next(
            (BY_SUFFIX[name] for name in _SUFFIXES_IN_TEXT if BY_SUFFIX[name].si == unit),
            Unit(unit, 1.0, unit),
        )

    def field_value(self, value: Any) -> Any:
        """Return a value in the unit of its field, rounded to the typed number; lists entry by entry."""
        unit = factor(self.name)
        if isinstance(value, dict):
            return {boundary_name(key): self.at(key).field_value(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [self.field_value(item) for item in value]
        if isinstance(value, bool) or not isinstance(value, int | float) or unit == 1.0:
            return super().field_value(value)
        return as_typed(value, unit) if math.isfinite(value) else value


@dataclass(frozen=True)
class _SceneReader(_CaseReader):
    """The words for a reader who wrote a scene file."""

    model: ClassVar[type[BaseModel]] = SceneInput

    @property
    def name(self) -> str:
        """The scene file's name of the field."""
        return scene_field(self.field)


def translated(error: Exception) -> ServiceError | None:
    """Return an error of the libraries as the boundary's, None for one they do not raise on purpose."""
    if isinstance(error, ContactInputError):
        return BadInput([_fault(error, _CaseReader(error.field))])
    if isinstance(error, DynamicsInputError):
        return BadInput([_fault(error, _SceneReader(error.field))])
    if isinstance(error, FeContactError | DynamicsError | WorkersLost | Unavailable):
        return JobFailed(str(error))
    if isinstance(error, ModuleNotFoundError) and (missing := missing_extra(error)):
        return JobFailed(str(missing))
    return None


def _fault(error: RefusedValue, reader: _CaseReader) -> Fault:
    bound = error.bound.worded(reader)
    if isinstance(error, InfeasibleGeometry):
        bound = f"{bound} ({error.name})"
    remedy = error.suggestion.worded(reader).strip() or field_remedy(reader.model, reader.name)
    return Fault(reader.name, reader.field_value(error.value), bound, remedy)
