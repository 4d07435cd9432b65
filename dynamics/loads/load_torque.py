"""A torque that resists a shaft's rotation."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.checks import finite
from dynamics.loads.time_law import TimeLaw


@dataclass(frozen=True)
class LoadTorque:
    """A resisting torque, independent of the speed.

    Attributes
    ----------
    name : str
        Unique among the loads.
    shaft : str
        The loaded shaft.
    torque : TimeLaw
        N m, > 0 against the sense in which the drive turns this shaft. The run starts in static
        equilibrium with its value at t = 0, so a constant load excites nothing.
    position : float
        Where along a flexible shaft it acts, m from its left end.
    """

    name: str
    shaft: str
    torque: TimeLaw
    position: float = 0.0

    def __post_init__(self) -> None:
        finite("position", self.position)
