"""A shaft whose rotation is imposed as a function of time, rigidly or through a torsional spring."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, up_to
from dynamics.checks import declared_fields
from dynamics.loads.angle_law import AngleLaw
from dynamics.loads.time_law import TimeLaw

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
