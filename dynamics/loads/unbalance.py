"""An unbalance: a rotor's center of mass off its axis."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, required
from dynamics.checks import declared_fields
from dynamics.loads.applied_force import POSITION

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
