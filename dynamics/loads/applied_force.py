"""Loads on shafts: torques that resist, forces and moments by time, speed or angle, unbalances."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, required
from dynamics.checks import declared_fields, finite
from dynamics.loads.load_course import CONSTANT, Course, SpeedCurve
from dynamics.loads.time_law import TimeLaw

_ON_SHAFT = Declared(
    Kind.LENGTH,
    "m",
    between(-1000.0, 1000.0),
    "Where along a flexible shaft it acts, in {unit} from its left end",
    0.0,
)
Vector = tuple[float, float, float]
POSITION = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Where along the shaft it acts, from its left end", 0.1
)
_AMOUNT = Declared(
    Kind.INERTIA,
    "kg m",
    between(1e-15, 1e6),
    "Amount: mass times its distance from the axis",
    1e-4,
)
_ANGLE = Declared(
    Kind.ANGLE,
    "rad",
    between(-math.tau, math.tau),
    "Angle of the heavy spot from +x about +z at the start",
    0.0,
)


@described
@dataclass(frozen=True)
class LoadTorque:
    """A resisting torque on a `shaft`, independent of the speed, its `name` unique among the loads.

    `torque`, N m, is > 0 against the sense in which the drive turns this shaft. The run starts in static
    equilibrium with its value at t = 0, so a constant load excites nothing.
    """

    name: str
    shaft: str
    torque: TimeLaw
    position: float = declared(0.0, _ON_SHAFT)

    def __post_init__(self) -> None:
        declared_fields(self)


@described
@dataclass(frozen=True)
class SpeedTorque:
    """A torque on a `shaft` by its speed: a fan that resists, a motor that drives.

    Its `name` is unique among the speed torques. `curve` is the torque against the sense of the shaft's
    kinematic motion, N m, at the speed in that sense, rad/s.
    """

    name: str
    shaft: str
    curve: SpeedCurve
    position: float = declared(0.0, _ON_SHAFT)

    def __post_init__(self) -> None:
        declared_fields(self)


@described
@dataclass(frozen=True)
class AppliedForce:
    """A force and moment at a point of a shaft's axis: rows (where it acts) x course x frame.

    The course is how its size varies, the frame what its direction turns with. `force` (N) and `moment` (N m;
    about x, y, and about +z, the axis) act on the shaft, along the fixed axes, times the factor of the
    `course`. With `turns_with` they are those at t = 0 and turn with the rotation of that shaft, its
    vibration included: a carrier or the shaft itself. `name` is unique among the forces. Both may be zero: a
    load case then says what they are.
    """

    name: str
    shaft: str
    position: float = required(POSITION)
    force: Vector = (0.0, 0.0, 0.0)
    moment: Vector = (0.0, 0.0, 0.0)
    course: Course = CONSTANT
    turns_with: str | None = None

    def __post_init__(self) -> None:
        declared_fields(self)
        for name in ("force", "moment"):
            for axis, value in zip("xyz", getattr(self, name), strict=True):
                finite(f"{name}.{axis}", value)


@described
@dataclass(frozen=True)
class Unbalance:
    """A point of a shaft off whose axis mass lies; that mass is part of the shaft's and its bodies' mass.

    `name` is unique among the unbalances. The shaft is described in the fixed frame.
    """

    name: str
    shaft: str
    position: float = required(POSITION)
    amount: float = required(_AMOUNT)
    angle: float = declared(0.0, _ANGLE)

    def __post_init__(self) -> None:
        declared_fields(self)
