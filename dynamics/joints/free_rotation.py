"""The reference motion of a train that no drive moves: torques alone make it turn."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, one_of
from dynamics.checks import declared_fields
from dynamics.errors import InputError
from dynamics.loads.time_law import TimeLaw

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
