"""A force and moment on a shaft, fixed in space or turning with a shaft, by time, speed or angle."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, described, required
from dynamics.checks import declared_fields, finite
from dynamics.loads.load_course import CONSTANT, Course

Vector = tuple[float, float, float]

POSITION = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Where along the shaft it acts, from its left end", 0.1
)


@described
@dataclass(frozen=True)
class AppliedForce:
    """A force and moment at a point of a shaft's axis: rows (where it acts) x course x frame.

    `force` (N) and `moment` (N m; about x, y, and about +z, the axis) act on the shaft, along the fixed axes,
    times the factor of the `course`. With `turns_with` they are those at t = 0 and turn with the rotation of
    that shaft, its vibration included: a carrier or the shaft itself. `name` is unique among the forces. Both
    may be zero: a load case then says what they are.
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
