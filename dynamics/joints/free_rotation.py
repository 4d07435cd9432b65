"""The reference motion of a train that no drive moves: torques alone make it turn."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.bodies.time_law import TimeLaw
from dynamics.checks import finite, one_of
from dynamics.errors import InputError


@dataclass(frozen=True)
class FreeRotation:
    """A shaft that starts at a given speed and then turns as torques make it.

    All shafts geared to it and to no drive turn freely with it, without limit.

    Attributes
    ----------
    name : str
        Unique among the free rotations.
    shaft : str
        Any one shaft of the train.
    initial_speed : float
        rad/s about the fixed +z axis.
    sense : str
        ``"+z"`` or ``"-z"``: where it will turn if the initial speed is 0; it sets the driving flanks.
    """

    name: str
    shaft: str
    initial_speed: float = 0.0
    sense: str = "+z"

    def __post_init__(self) -> None:
        finite("initial_speed", self.initial_speed)
        one_of("sense", self.sense, ("+z", "-z"))
        if self.initial_speed * self.forward < 0.0:
            raise InputError("sense", self.sense, "that of the initial speed", "Turn one of them.")

    @property
    def forward(self) -> int:
        """The sense as +1 or -1 about +z."""
        return 1 if self.sense == "+z" else -1

    @property
    def speed(self) -> TimeLaw:
        """The reference motion: the initial speed for ever."""
        return TimeLaw.constant(self.initial_speed)

    @property
    def rigid(self) -> bool:
        """Whether the shaft's rotation is no freedom."""
        return False
