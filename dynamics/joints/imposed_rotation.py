"""A shaft whose rotation is imposed as a function of time."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.bodies.time_law import TimeLaw


@dataclass(frozen=True)
class ImposedRotation:
    """The drive: a shaft turns by a given law, whatever torque that takes.

    Attributes
    ----------
    name : str
        Unique among the drives.
    shaft : str
        The driven shaft.
    speed : TimeLaw
        rad/s about the fixed +z axis. The angle is its exact integral from t = 0, where it is 0.
    """

    name: str
    shaft: str
    speed: TimeLaw
