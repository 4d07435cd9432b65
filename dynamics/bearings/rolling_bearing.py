"""A rolling bearing between a shaft and the ground, by the geometry of its row."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, required
from dynamics.bearings import seat
from dynamics.bearings.ball_bearing import BallBearing
from dynamics.bearings.bushing import Bushing
from dynamics.bearings.roller_bearing import BOTH, LOCATING, RollerBearing, check_locating
from dynamics.checks import declared_fields
from dynamics.errors import InputError

AXIAL_PRELOAD = Declared(
    Kind.FORCE,
    "N",
    between(-1e9, 1e9),
    "Axial force of the inner ring on the outer where the shaft is not displaced; along z, with the sign of "
    "the contact angle",
    500.0,
)
DAMPING_RATIO = Declared(
    Kind.RATIO,
    "",
    between(0.0, 10.0),
    "Damping ratio of the shaft bouncing on its bearings under the nominal mesh forces",
    0.05,
)
DYNAMIC_CAPACITY = Declared(
    Kind.FORCE,
    "N",
    between(1.0, 1e9),
    "Basic dynamic load rating C of the row (ISO 281), from which its rating life follows; default: no life",
    22500.0,
    later=True,
)


@described
@dataclass(frozen=True)
class RollingBearing:
    """One row of balls or rollers whose inner ring sits on the shaft and whose outer ring the ground holds.

    Its five displacements are those of the shaft's section; force and moment are about the row's center. Rows
    of one bearing, or bearings side by side, are several of these, each at its own position.

    Its rings are held in their seats along the axis, or one slides: a non-locating ball bearing carries no
    axial force (`locating`). Of cylindrical rollers it changes nothing.

    An element of load Q pushes back with ``Q (1 + d p')``, p' the rate at which it is pressed, and never
    pulls (Hunt and Crossley); d follows from `damping_ratio` with the mass of the shaft and its gears divided
    by the number of its bearings.
    """

    name: str
    shaft: str
    row: BallBearing | RollerBearing
    position: float = required(seat.POSITION)
    axial_preload: float = declared(0.0, AXIAL_PRELOAD)
    damping_ratio: float = declared(0.05, DAMPING_RATIO)
    dynamic_capacity: float | None = declared(None, DYNAMIC_CAPACITY)
    locating: str = declared(BOTH, LOCATING)

    def __post_init__(self) -> None:
        declared_fields(self)
        angle, preload = self.row.contact_angle, self.axial_preload
        if preload != 0.0 and angle == 0.0 and isinstance(self.row, RollerBearing):
            bound = "0: cylindrical rollers carry no axial force"
            raise InputError("axial_preload", preload, bound)
        if preload * angle < 0.0:
            bound = f"{'positive' if angle > 0.0 else 'negative'}, as the contact angle is"
            raise InputError("axial_preload", preload, bound, "The row carries no other axial force.")
        check_locating(self.row, self.locating)
        if preload != 0.0 and self.locating != BOTH:
            bound = f'0 where a ring slides (locating = "{self.locating}")'
            raise InputError("axial_preload", preload, bound, f'State locating = "{BOTH}", or no preload.')

    @property
    def bushing(self) -> str:
        """Name of the support whose force it is."""
        return self.name

    @property
    def support(self) -> Bushing:
        """The support at which it acts, without any stiffness of its own."""
        return Bushing(self.name, self.shaft, self.position)
