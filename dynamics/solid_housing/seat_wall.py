"""The wall of a bearing seat by its size, and what it does."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum, auto

from bounds import Declared, Kind, declared, described, one_of, required, up_to
from dynamics.checks import declared_fields


class Ring(StrEnum):
    """What a seat's wall does.

    ``WEIGHTED_AVERAGE``: it stays elastic; its motion is the rigid motion nearest to that of the wall in
    the mean square over its area, and a force is spread by the same weights (RBE3). ``RIGID``: it moves as a
    rigid ring (RBE2), which stiffens the housing.
    """

    WEIGHTED_AVERAGE = auto()
    RIGID = auto()


BORE_DIAMETER = Declared(Kind.LENGTH, "m", up_to(20.0), "Diameter of the bore", 0.062)
BORE_LENGTH = Declared(Kind.LENGTH, "m", up_to(20.0), "Length of the bore along its axis", 0.025)
_RING = Declared(
    Kind.CHOICE,
    "",
    one_of([ring.value for ring in Ring]),
    "Wall of the bore: weighted_average: elastic, moved by its mean (RBE3); rigid: a rigid ring (RBE2)",
    Ring.WEIGHTED_AVERAGE.value,
)


@described
@dataclass(frozen=True)
class SeatWall:
    """The wall of a bearing seat; where it is follows from its bearing."""

    bore_diameter: float = required(BORE_DIAMETER)
    bore_length: float = required(BORE_LENGTH)
    ring: str = declared(Ring.WEIGHTED_AVERAGE.value, _RING)

    def __post_init__(self) -> None:
        declared_fields(self)
