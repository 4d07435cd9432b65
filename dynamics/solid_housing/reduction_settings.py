"""How the solid of a housing is meshed and reduced."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, integers, up_to
from dynamics.checks import declared_fields

MODES = Declared(
    Kind.COUNT,
    "",
    integers(1, 2000),
    "Modes to keep; responses hold to 0.7 of the highest frequency",
    80,
    later=True,
)
ELEMENT_SIZE = Declared(
    Kind.LENGTH,
    "m",
    up_to(20.0),
    "Edge of an element of a STEP file's mesh; left out: the mean wall thickness over 0.7",
    0.014,
    later=True,
)
LOSS_FACTOR = Declared(
    Kind.RATIO,
    "",
    between(0.0, 1.0),
    "Loss factor of the material and its joints",
    0.01,
    later=True,
)


@described
@dataclass(frozen=True)
class ReductionSettings:
    """Settings of mesh, modes and damping.

    With a loss factor a mode is damped by the share of the housing in its strain energy; without one all
    modes have the damping ratio of the housing.
    """

    modes: int = declared(80, MODES)
    element_size: float | None = declared(None, ELEMENT_SIZE)
    loss_factor: float | None = declared(None, LOSS_FACTOR)

    def __post_init__(self) -> None:
        declared_fields(self)
