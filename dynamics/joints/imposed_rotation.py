"""A shaft whose rotation is imposed as a function of time, rigidly or through a torsional spring."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.bodies.angle_law import AngleLaw
from dynamics.bodies.time_law import TimeLaw
from dynamics.checks import finite, not_negative, positive


@dataclass(frozen=True)
class ImposedRotation:
    """A drive: a shaft turns by a given law, whatever torque that takes.

    Attributes
    ----------
    name : str
        Unique among the drives.
    shaft : str
        The driven shaft.
    speed : TimeLaw or AngleLaw
        rad/s about the fixed +z axis; 0: held. The angle is its exact integral from t = 0, where it is 0. An
        `AngleLaw` gives it by the angle over time.
    stiffness : float or None
        N m/rad of a torsional spring between the imposed motion and the shaft, e.g. the torsional support
        of a held ring gear. None: rigid.
    damping : float
        N m s/rad beside the spring.
    position : float
        Where along a flexible shaft the motion is imposed, m from its left end.
    """

    name: str
    shaft: str
    speed: TimeLaw | AngleLaw
    stiffness: float | None = None
    damping: float = 0.0
    position: float = 0.0

    def __post_init__(self) -> None:
        if self.stiffness is not None:
            positive("stiffness", self.stiffness, "Leave it out for a rigid drive.")
        not_negative("damping", self.damping)
        finite("position", self.position)

    @property
    def rigid(self) -> bool:
        """Whether the shaft's rotation is no freedom."""
        return self.stiffness is None
