"""Motion and loads of a scene: drives, free rotations, torques."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, Strict, model_validator

from dynamics.joints.rotations import FreeRotation, ImposedRotation
from dynamics.loads.applied_force import LoadTorque, SpeedTorque
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import (
    BoundaryModel,
    Course,
    Listed,
    Name,
    Number,
    Numbers,
    Times,
    refuse,
    refuse_unsorted,
)
from lineofaction.gearbox.schemas.rules import all_of, exactly_one_of

Orders = Annotated[tuple[Annotated[float, Field(gt=0.0, le=1e4)], ...], Strict(False)]
Vector = Annotated[tuple[Number, ...], Field(min_length=3, max_length=3), Strict(False)]
ACTING = ("force_n", "moment_n_m")
BY = ("time_s", "speed_rpm", "orders", "turn_factor")


@with_fields(declared_in(ImposedRotation))
class DriveInput(BoundaryModel):
    """A shaft whose speed or angle is imposed over time."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of("speed_rpm", "angle_deg")))

    name: Name = Field(description="Name of the drive", examples=["motor"])
    shaft: Name = Field(description="The driven shaft", examples=["input"])
    time_s: Times = Field(default=(0.0,), description="Times in s", examples=[[0.0, 5.0]])
    speed_rpm: Numbers | None = Field(
        default=None, description="Speeds in rpm at these times", examples=[[0.0, 955.0]]
    )
    angle_deg: Listed[Number] | None = Field(
        default=None,
        min_length=4,
        max_length=100_000,
        description="Angles in degrees at these times instead of speeds, joined by a cubic spline",
        examples=[[0.0, 1.0, 2.1, 3.0]],
    )
    course: Course = Field(default="linear", description="Course between the times", examples=["linear"])

    @model_validator(mode="after")
    def _law(self) -> Self:
        if (self.speed_rpm is None) == (self.angle_deg is None):
            bound = "given, or angle_deg instead, but not both"
            refuse("speed_rpm", self.speed_rpm and list(self.speed_rpm), bound, "For example [1000.0].")
        if self.speed_rpm is not None:
            _check_law("speed_rpm", self.time_s, self.speed_rpm)
        if self.angle_deg is not None:
            _check_law("angle_deg", self.time_s, self.angle_deg)
        return self


@with_fields(declared_in(FreeRotation))
class FreeRotationInput(BoundaryModel):
    """A train that no drive moves: it starts at a speed and turns as torques make it."""

    name: Name = Field(description="Name of the free rotation", examples=["train"])
    shaft: Name = Field(description="Any one shaft of the train", examples=["input"])


@with_fields(declared_in(LoadTorque, marked=False))
class LoadTorqueInput(BoundaryModel):
    """A torque that resists a shaft's rotation, or drives it where it is negative."""

    name: Name = Field(description="Name of the load", examples=["brake"])
    shaft: Name = Field(description="The loaded shaft", examples=["output"])
    position_mm: float
    time_s: Times = Field(default=(0.0,), description="Times in s", examples=[[0.0]])
    torque_n_m: Numbers = Field(description="Resisting torques in N m at these times", examples=[[100.0]])
    course: Course = Field(default="linear", description="Course between the times", examples=["linear"])

    @model_validator(mode="after")
    def _law(self) -> Self:
        _check_law("torque_n_m", self.time_s, self.torque_n_m)
        return self


@with_fields(declared_in(SpeedTorque, marked=False))
class SpeedTorqueInput(BoundaryModel):
    """A torque that depends on the shaft's speed."""

    name: Name = Field(description="Name of the torque", examples=["fan"])
    shaft: Name = Field(description="The shaft it acts on", examples=["output"])
    position_mm: float
    kind: Literal["table", "quadratic", "constant"] = Field(
        description="Law: a table, the square of the speed, or a constant against either sense of rotation",
        examples=["table"],
    )
    speed_rpm: Numbers = Field(
        description="Speeds in rpm: of the table, of the torque of a square, or at which a constant is "
        "reached",
        examples=[[0.0, 1500.0]],
    )
    torque_n_m: Numbers = Field(
        description="Torques in N m against the rotation at these speeds; negative: driving",
        examples=[[-50.0, -40.0]],
    )

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        """Refuse a table of fewer than two points, and more than one for the others."""
        minimum, maximum = (2, 100_000) if self.kind == "table" else (1, 1)
        if not minimum <= len(self.speed_rpm) <= maximum:
            bound = "a list of at least 2" if self.kind == "table" else "a list of one"
            refuse("speed_rpm", list(self.speed_rpm), bound)
        if len(self.torque_n_m) != len(self.speed_rpm):
            bound = f"a list of {len(self.speed_rpm)}, one for each of speed_rpm"
            refuse("torque_n_m", list(self.torque_n_m), bound, "Give one value per speed.")
        return self


def _check_law(field: str, times: tuple[float, ...], values: tuple[float, ...]) -> None:
    refuse_unsorted("time_s", times)
    if len(times) != len(values):
        refuse(
            field, list(values), f"a list of {len(times)}, one for each of time_s", "Give one value per time."
        )
