"""Forces and unbalances of a scene."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.loads.applied_force import AppliedForce, Unbalance
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.loads import ACTING, BY, Orders, Vector
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
from lineofaction.gearbox.schemas.rules import all_of, at_least_one_of, at_most_one_of


@with_fields(declared_in(AppliedForce))
class ForceInput(BoundaryModel):
    """A force and moment on a shaft: constant, by time, by a shaft's speed, or by a shaft's angle."""

    model_config = ConfigDict(json_schema_extra=all_of(at_most_one_of(*BY), at_least_one_of(*ACTING)))

    name: Name = Field(description="Name of the force", examples=["belt"])
    shaft: Name = Field(description="The shaft it acts on", examples=["input"])
    force_n: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Force in x, y, z in N, times the factor; 0 where load cases alone state it",
        examples=[[0.0, 500.0, 0.0]],
    )
    moment_n_m: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Moment about x, y and +z in N m, times the factor; the last is a torque",
        examples=[[0.0, 0.0, 20.0]],
    )
    turns_with: Name | None = Field(
        default=None,
        description="A shaft or carrier that force and moment turn with; left out: fixed in space",
        examples=["input"],
    )
    of_shaft: Name | None = Field(
        default=None,
        description="The shaft whose speed or angle the factor depends on; left out: the shaft it acts on",
        examples=["input"],
    )
    time_s: Times | None = Field(
        default=None, description="Factor by time: times in s", examples=[[0.0, 1.0]]
    )
    speed_rpm: Listed[Number] | None = Field(
        default=None,
        min_length=2,
        max_length=100_000,
        description="Factor by speed: speeds in rpm in the sense in which the shaft turns",
        examples=[[0.0, 3000.0]],
    )
    factor: Numbers | None = Field(
        default=None, description="Factors at these times or speeds; left out: 1", examples=[[0.0, 1.0]]
    )
    course: Course = Field(default="linear", description="Course between the times", examples=["linear"])
    orders: Orders | None = Field(
        default=None,
        min_length=1,
        max_length=10_000,
        description="Factor by angle: mean + sum of amplitude cos(order angle + phase); orders are events "
        "per turn, multiples of 1/d with a whole number d up to 1000",
        examples=[[2.0]],
    )
    amplitude: Listed[Number] | None = Field(
        default=None, max_length=10_000, description="Amplitudes of the orders", examples=[[0.1]]
    )
    phase_deg: Listed[Number] | None = Field(
        default=None,
        max_length=10_000,
        description="Phases of the orders in degrees; left out: 0",
        examples=[[0.0]],
    )
    mean: Number = Field(default=0.0, description="Mean of the factor by orders", examples=[1.0])
    turn_factor: Listed[Number] | None = Field(
        default=None,
        min_length=3,
        max_length=20_000,
        description="Factor by angle: values at equal steps over one turn, the first at t = 0",
        examples=[[1.0, 0.5, 0.0, 0.5]],
    )

    @model_validator(mode="after")
    def _acts(self) -> Self:
        """Refuse a force of which neither force nor moment is given."""
        if not self.model_fields_set.intersection(ACTING):
            remedy = "If it acts under load cases alone, give 0."
            refuse("force_n", None, "given, or moment_n_m", remedy)
        return self

    @model_validator(mode="after")
    def _one_course(self) -> Self:
        """Refuse more than one course, and lists of different lengths."""
        courses = [name for name in BY if getattr(self, name) is not None]
        if len(courses) > 1:
            refuse(courses[1], courses, f"left out beside {courses[0]}", "Give one course.")
        course = courses[0] if courses else None
        points = getattr(self, course) if course in ("time_s", "speed_rpm") else None
        _as_many("factor", self.factor, course or "time_s", points)
        refuse_unsorted(str(course), points)
        _as_many("amplitude", self.amplitude, "orders", self.orders)
        _as_many("phase_deg", self.phase_deg, "orders", self.orders, optional=True)
        if self.mean and self.orders is None:
            refuse("mean", self.mean, "0 without orders", "Scale the force.")
        return self


@with_fields(declared_in(Unbalance))
class UnbalanceInput(BoundaryModel):
    """Mass off a shaft's axis, part of the mass of the shaft and its bodies."""

    name: Name = Field(description="Name of the unbalance", examples=["rotor"])
    shaft: Name = Field(description="The unbalanced shaft", examples=["input"])


def _as_many(
    field: str,
    values: tuple[float, ...] | None,
    axis: str,
    points: tuple[float, ...] | None,
    optional: bool = False,
) -> None:
    """Refuse a list that does not have one value for each of the points."""
    if points is None and values is not None:
        refuse(field, list(values), f"left out without {axis}", "Say at what these values hold.")
    if points is not None and (values is not None or not optional) and len(values or ()) != len(points):
        bound = f"a list of {len(points)}, one for each of {axis}"
        refuse(field, None if values is None else list(values), bound, "Give one value each.")
