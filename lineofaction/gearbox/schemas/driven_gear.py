"""The driven gear of the case file: an external gear, or a ring gear with the pinion inside it."""

from __future__ import annotations

from dataclasses import MISSING, replace
from typing import Any, Self

from pydantic import ConfigDict, Field, model_validator

from bounds import Interval, declarations
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.ring_gear import RingGear
from lineofaction.gearbox.schemas.declared import as_fields, figures, with_fields
from lineofaction.gearbox.schemas.gear import ToothingInput
from lineofaction.gearbox.schemas.model import refuse
from lineofaction.gearbox.schemas.rules import absent, all_of, both, required

RING = tuple(figure for figure in figures(RingGear) if figure not in figures(Gear))
"""Fields that only a ring gear has, or that differ from the fields of an external gear."""
_DEFAULTS = {
    figure.field: figure.boundary_value(figure.default) for figure in RING if figure.default is not MISSING
}
_RING_ONLY = tuple(figure for figure in RING if figure.name not in declarations(Gear))
_GEAR_ONLY = tuple(figure for figure in figures(Gear) if figure.name not in declarations(RingGear))
_NEGATIVE = {
    figure.field: (figure.boundary_value(bound.ge or 0.0), figure.boundary_value(bound.le))
    for figure in figures(RingGear)
    if figure.field in ("teeth", "tip_diameter_mm", "rim_diameter_mm")
    and isinstance(bound := figure.what.bound, Interval)
}
"""Sizes, from and to, of the fields of a ring gear that are negative in ISO 21771-1."""
_IS_RING = {"required": ["internal"], "properties": {"internal": {"const": True}}}
_RING_HAS = both(required("rim_diameter_mm"), absent("bore_diameter_mm", "blank", "seat", "sector_teeth"))
_GEAR_HAS = both(required("bore_diameter_mm"), absent(*(figure.field for figure in _RING_ONLY)))


def _of_either_kind(schema: dict[str, Any]) -> None:
    """Add to a schema the fields of each kind of gear, and the defaults of a ring gear."""
    schema |= all_of({"if": _IS_RING, "then": _RING_HAS, "else": _GEAR_HAS})
    for name, value in _DEFAULTS.items():
        schema["properties"][name]["x-usual"] = {"value": value, "with": ["internal"]}


def _of_positive_counts(data: Any) -> Any:
    """Return a ring gear that has negative teeth and diameters, as ISO 21771-1 writes it, with positive ones.

    The profile shift has the sign of the standard in either form.
    """
    if not isinstance(data, dict) or not _is_negative("teeth", data.get("teeth")):
        return data
    sizes = {name: -value for name, value in data.items() if _is_negative(name, value)}
    return {**data, "internal": True, **sizes}


def _is_negative(name: str, value: Any) -> bool:
    """Whether a value is in the standard's form of a ring gear; others are refused as they are written."""
    if name not in _NEGATIVE or isinstance(value, bool) or not isinstance(value, int | float):
        return False
    minimum, maximum = _NEGATIVE[name]
    return bool(value < 0 and minimum <= -value <= maximum)


@with_fields(as_fields(replace(figure, default=None) for figure in (*_GEAR_ONLY, *_RING_ONLY)))
class WheelInput(ToothingInput):
    """The driven gear, external or internal. Each kind leaves out the fields of the other."""

    model_config = ConfigDict(json_schema_extra=_of_either_kind)

    internal: bool = Field(
        default=False, description="Whether the wheel is a ring gear around the pinion", examples=[True]
    )
    bore_diameter_mm: float | None
    rim_diameter_mm: float | None

    @model_validator(mode="before")
    @classmethod
    def _ring_defaults(cls, data: Any) -> Any:
        """Fill in the defaults of a ring gear, so that the echo has them."""
        data = _of_positive_counts(data)
        if isinstance(data, dict) and data.get("internal") is True:
            return _DEFAULTS | {name: value for name, value in data.items() if value is not None}
        return data

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        """Refuse missing fields of one kind, and fields that belong to the other."""
        if self.internal:
            self._check_ring()
            return self
        if self.bore_diameter_mm is None:
            remedy = "Bore diameter in mm. For example 40.0; or internal = true for a ring gear."
            refuse("bore_diameter_mm", None, "given", remedy)
        for figure in _RING_ONLY:
            value = getattr(self, figure.field)
            if value is not None:
                bound = "left out, or given with internal = true"
                refuse(figure.field, value, bound, "Only a ring gear has it.")
        return self

    def _check_ring(self) -> None:
        if self.rim_diameter_mm is None:
            remedy = "Outer diameter in mm of the ring gear's rim. For example 212.0."
            refuse("rim_diameter_mm", None, "given with internal = true", remedy)
        bound = "left out with internal = true"
        if self.bore_diameter_mm is not None:
            remedy = "A ring gear is held by rim_diameter_mm."
            refuse("bore_diameter_mm", self.bore_diameter_mm, bound, remedy)
        for name in ("blank", "seat", "sector_teeth"):
            value = getattr(self, name)
            if value is not None:
                remedy = "The rim of a ring gear is solid, and held rigidly all round."
                refuse(name, value if isinstance(value, int) else "given", bound, remedy)
