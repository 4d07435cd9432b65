"""A complaint about a sound: its frequency or order, the speed, and the place."""

from __future__ import annotations

from typing import Any, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, Point, refuse
from lineofaction.gearbox.schemas.rules import all_of, at_most_one_of, exactly_one_of

WHATS, SPEEDS = ("frequency_hz", "order"), ("road_speed_km_h", "speed_rpm")
"""Fields of the sound, a frequency or an order, and fields of the speed: at most one each."""
OF_ROAD = ("tire_radius_mm", "final_shaft", "final_ratio")
"""Fields that a road speed needs and a shaft speed does not."""

_MIN = {
    "frequency_hz": (20.0, "Hz", "Lower ones are not heard. In kHz? Then write {:g}."),
    "road_speed_km_h": (1.0, "km/h", "Write kilometers per hour, such as 40.0."),
    "tire_radius_mm": (50.0, "mm", "In meters? Then write {:g}."),
}
"""Least value of a field, its unit, and the remedy for a lower value.

A lower value is probably in a unit 1000 times as large; {:g} in a remedy stands for the converted value.
"""


class ComplaintFields(BoundaryModel):
    """Fields of a complaint, each of which may be left out."""

    frequency_hz: float | None = Field(
        default=None,
        title="Frequency, Hz",
        gt=0.0,
        le=1e5,
        description="Frequency that is heard in Hz",
        examples=[400.0],
    )
    order: float | None = Field(
        default=None,
        title="or order",
        gt=0.0,
        le=1e5,
        description="Order that is heard, per revolution of `shaft`, in place of the frequency",
    )
    road_speed_km_h: float | None = Field(default=None, gt=0.0, le=600.0, description="Road speed in km/h")
    tire_radius_mm: float | None = Field(
        default=None, gt=0.0, le=2000.0, description="Rolling radius of the tires in mm"
    )
    final_shaft: str | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Shaft that turns the wheels; left out: the only one with a load",
    )
    final_ratio: float | None = Field(
        default=None,
        gt=0.0,
        le=1000.0,
        description="Revolutions of that shaft per revolution of a wheel; left out: 1",
    )
    speed_rpm: float | None = Field(
        default=None,
        title="Speed, rpm",
        gt=0.0,
        le=1e7,
        description="Speed of `shaft` in rpm, in place of the road speed",
        examples=[1200.0],
    )
    shaft: str | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Shaft of speed_rpm and order; left out: the first driven one",
    )
    tolerance_percent: float | None = Field(
        default=None,
        ge=0.1,
        le=20.0,
        description="Tolerance of frequency and speed together, in percent; left out: 5",
        examples=[5.0],
    )
    orders: int | None = Field(
        default=None,
        ge=1,
        le=100,
        description="Highest harmonic of every mesh that is compared; left out: 10",
        examples=[10],
    )
    bearing: str | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Bearing where the vibration is measured, a bushing or rolling bearing; left out: the "
        "most loaded",
    )
    torque_n_m: float | None = Field(
        default=None,
        gt=0.0,
        le=1e9,
        description="Torque on the driving gear of a case at which the complaint is made; left out: the "
        "highest torque",
    )
    microphone_mm: Point | None = Field(
        default=None,
        description="Microphone, x, y, z in mm: needs a housing with a surface",
    )


class ComplaintInput(ComplaintFields):
    """A complaint: a frequency at a road speed or at a shaft's speed, or an order."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of(*WHATS), at_most_one_of(*SPEEDS)))

    @model_validator(mode="after")
    def _one_question(self) -> Self:
        """Say which of the fields contradict each other, are missing, or are in another unit."""
        if self.frequency_hz is None and self.order is None:
            refuse("frequency_hz", None, "given, or order instead", "For example 1400.0, with a speed.")
        for names in (WHATS, SPEEDS):
            first, second = (getattr(self, name) for name in names)
            if first is not None and second is not None:
                refuse(names[1], second, f"left out beside {names[0]}", "Give one of them.")
        if self.frequency_hz is not None and self.road_speed_km_h is None and self.speed_rpm is None:
            bound = "given with a frequency, or road_speed_km_h instead"
            refuse("speed_rpm", None, bound, "For example 3360.0; or give the order.")
        for name in OF_ROAD:
            value = getattr(self, name)
            if value is not None and self.road_speed_km_h is None:
                refuse(name, value, "left out without road_speed_km_h", "Give the road speed too.")
        if self.road_speed_km_h is not None and self.tire_radius_mm is None:
            refuse("tire_radius_mm", None, "given with a road speed", "Its rolling radius, such as 310.0.")
        for name, (minimum, unit, remedy) in _MIN.items():
            value = getattr(self, name)
            if value is not None and value < minimum:
                refuse(name, value, f"at least {minimum:g} {unit}", remedy.format(1e3 * value))
        return self


def with_options(complaint: ComplaintInput | None, options: ComplaintFields) -> dict[str, Any]:
    """Return the fields of a complaint, overridden by the options' fields, not yet validated.

    An option also replaces the field that it is an alternative to.
    """
    fields = {} if complaint is None else complaint.model_dump(exclude_none=True)
    typed = options.model_dump(exclude_none=True, include=set(ComplaintFields.model_fields))
    for names in (WHATS, SPEEDS):
        if typed.keys() & set(names):
            fields = {name: value for name, value in fields.items() if name not in names}
    if "speed_rpm" in typed:
        fields = {name: value for name, value in fields.items() if name not in OF_ROAD}
    return fields | typed
