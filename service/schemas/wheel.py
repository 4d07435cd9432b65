"""The driven gear of the case file: an external gear, or a ring gear with the pinion inside it."""

from __future__ import annotations

from typing import Any, Self

from pydantic import Field, model_validator

from service.schemas.gear import ToothingInput
from service.schemas.model import refuse

_RING_DEFAULTS = {
    "root_radius_coefficient": 0.2,
    "cutter_teeth": 25,
    "cutter_profile_shift_coefficient": 0.0,
}
_RING_ONLY = ("rim_diameter_mm", "cutter_teeth", "cutter_profile_shift_coefficient")


class WheelInput(ToothingInput):
    """The driven gear. What only one kind has is left out by the other."""

    internal: bool = Field(
        default=False, description="Whether the wheel is a ring gear around the pinion", examples=[True]
    )
    bore_diameter_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=20_000.0,
        description="Bore diameter in mm of an external wheel",
        examples=[40.0],
    )
    rim_diameter_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=50_000.0,
        description="Outer diameter in mm of a ring gear's rim, which is held rigidly all round",
        examples=[212.0],
    )
    cutter_teeth: int | None = Field(
        default=None,
        ge=6,
        le=1000,
        description="Teeth of the pinion cutter that makes a ring gear; left out: 25",
        examples=[25],
    )
    cutter_profile_shift_coefficient: float | None = Field(
        default=None,
        ge=-3.0,
        le=3.0,
        description="Profile shift of that cutter in normal modules; left out: 0",
        examples=[0.0],
    )

    @model_validator(mode="before")
    @classmethod
    def _ring_defaults(cls, data: Any) -> Any:
        """Fill in a ring gear's tool, so that the echo says so; its tip rounding makes the root."""
        if isinstance(data, dict) and data.get("internal") is True:
            return _RING_DEFAULTS | {name: value for name, value in data.items() if value is not None}
        return data

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        """Refuse what is missing from one kind, and what belongs to the other."""
        if self.internal:
            self._check_ring()
            return self
        if self.bore_diameter_mm is None:
            advice = "Bore diameter in mm. For example 40.0; or internal = true for a ring gear."
            refuse("bore_diameter_mm", None, "given", advice)
        for name in _RING_ONLY:
            if getattr(self, name) is not None:
                bound = "left out, or given with internal = true"
                refuse(name, getattr(self, name), bound, "Only a ring gear has it.")
        return self

    def _check_ring(self) -> None:
        """Refuse a ring gear without its rim, or with a bore."""
        if self.rim_diameter_mm is None:
            advice = "Outer diameter in mm of the ring gear's rim. For example 212.0."
            refuse("rim_diameter_mm", None, "given with internal = true", advice)
        if self.bore_diameter_mm is not None:
            bound = "left out with internal = true"
            refuse(
                "bore_diameter_mm", self.bore_diameter_mm, bound, "A ring gear is held by rim_diameter_mm."
            )
        for name in ("blank", "seat"):
            if getattr(self, name) is not None:
                advice = "The rim of a ring gear is solid, and held rigidly all round."
                refuse(name, "given", "left out with internal = true", advice)
