"""Laws of a shaft's rotation: imposed over time, rigidly or through a spring, or free under torques alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, one_of, up_to
from dynamics.checks import declared_fields
from dynamics.errors import InputError
from dynamics.loads.time_law import AngleLaw, TimeLaw

_STIFFNESS = Declared(
    Kind.STIFFNESS,
    "N m/rad",
    up_to(1e15),
    "Torsional spring to the imposed rotation, such as the support of a held ring gear; left out: rigid",
    1e7,
)
_DAMPING = Declared(Kind.DAMPING, "N m s/rad", between(0.0, 1e12), "Damping beside that spring", 0.0)
_POSITION = Declared(
    Kind.LENGTH,
    "m",
    between(-1000.0, 1000.0),
    "Position along a flexible shaft where the motion is imposed, from its left end",
    0.0,
)
_FASTEST = 1e7 * math.pi / 30.0
_SPEED = Declared(
    Kind.SPEED,
    "rad/s",
    between(-_FASTEST, _FASTEST),
    "Speed at the start, about the fixed +z axis; afterwards the torques determine it",
    105.0,
)
_SENSE = Declared(
    Kind.CHOICE,
    "",
    one_of(("+z", "-z")),
    "Sense of rotation after a start from rest; it sets the driving flanks",
    "+z",
)


@described
@dataclass(frozen=True)
class ImposedRotation:
    """A drive: a shaft turns by a given law, at any torque.

    `speed` is in rad/s about the fixed +z axis; 0: held. The angle is its exact integral from t = 0, where it
    is 0. An `AngleLaw` gives it by the angle over time.
    """

    name: str
    shaft: str
    speed: TimeLaw | AngleLaw
    stiffness: float | None = declared(None, _STIFFNESS)
    damping: float = declared(0.0, _DAMPING)
    position: float = declared(0.0, _POSITION)

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def rigid(self) -> bool:
        """Whether the shaft's rotation is no freedom."""
        return self.stiffness is None


@described
@dataclass(frozen=True)
class FreeRotation:
    """A shaft that starts at a given speed and then follows the torques.

    All shafts geared to it and to no drive turn freely with it, without limit; `shaft` is any one of them.
    """

    name: str
    shaft: str
    initial_speed: float = declared(0.0, _SPEED)
    sense: str = declared("+z", _SENSE)

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.initial_speed * self.forward < 0.0:
            raise InputError("sense", self.sense, "that of the initial speed", "Turn one of them.")

    @property
    def forward(self) -> int:
        """The sense as +1 or -1 about +z."""
        return 1 if self.sense == "+z" else -1

    @property
    def speed(self) -> TimeLaw:
        """The reference motion at the initial speed."""
        return TimeLaw.constant(self.initial_speed)

    @property
    def rigid(self) -> bool:
        """Whether the shaft's rotation is no freedom."""
        return False
