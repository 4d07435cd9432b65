"""A bearing's five strains by the bodies, and supports as rows of springs: to ground, housing seat or pin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.seat import SEAT
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, housing_columns, section, section_rows
from dynamics.mechanism.rotor import Rotor
from dynamics.types import BoolArray, FloatArray


def seat_motion(rotors: Bodies, index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the strains of a support of rotor `index` per freedom, (5, N): x, y, z, tilt_x, tilt_y.

    Of a planet bearing: the motion of the planet's section less that of the pin, which goes with the carrier.
    In a housing with mass: the motion of the shaft's section less that of the seat.
    """
    rotor = rotors[index]
    z = rotor.shaft.origin[2] + support.position
    row = section_rows(rotors, index, z)[:SEAT]
    if isinstance(support, PlanetBearing):
        carrier = _carrier_of(rotor, support)
        pin = section(rotors[carrier], np.array([*rotor.center[:2], z]))[:SEAT]
        row[:, 6 * carrier : 6 * carrier + 6] -= pin
    return row - carried_seat(rotors, support.name)


def carried_seat(rotors: Bodies, bearing: str) -> FloatArray:
    """Return the motion of a bearing's seat per freedom, (5, N): zero but in a housing with mass."""
    row, index = np.zeros((SEAT, column_count(rotors))), rotors.housing_of(bearing)
    if index is not None:
        row[:, housing_columns(rotors, index)] = rotors.housings[index].seat(bearing)
    return row


def seat_axes(rotors: Sequence[Rotor], index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the matrix that turns strains into the support's own axes, (5, 5).

    Those of a planet bearing point away from the carrier's axis and along z x (away).
    """
    if not isinstance(support, PlanetBearing):
        return np.eye(SEAT)
    offset = rotors[index].center - rotors[_carrier_of(rotors[index], support)].center
    c, s = offset[:2] / np.hypot(offset[0], offset[1])
    turn = np.eye(SEAT)
    turn[:2, :2] = turn[3:, 3:] = [[c, s], [-s, c]]
    return turn


def seat_error(rotors: Sequence[Rotor], index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the strains at which a support exerts no force, (5,): of a pin off its nominal position, m."""
    if not isinstance(support, PlanetBearing):
        return np.zeros(SEAT)
    errors = np.array([support.radial_error, support.tangential_error, 0.0, 0.0, 0.0])
    return np.asarray(seat_axes(rotors, index, support).T @ errors)


def _carrier_of(rotor: Rotor, bearing: PlanetBearing) -> int:
    if rotor.carrier is None:
        raise ValueError(f"{bearing.name}: not on a planet")  # the scene's checks come first
    return rotor.carrier


@dataclass(frozen=True)
class Supports:
    """b supports, each three springs and dampers along x, y, z: bushings by rotor, then planet bearings."""

    name: tuple[str, ...]
    frame: tuple[int | None, ...]
    """Rotor of the carrier whose rotating frame the ground is seen from; None: forces are in the fixed frame
    as they are, or, of a planet bearing, stay in the carrier's.
    """
    motion: FloatArray
    """Strain per freedom: displacement of the axis there, less that of the pin on a planet bearing, of the
    seat in a housing with mass. Shape (b, 3, N).
    """
    seat: FloatArray
    """Of the seat alone: zero but in a housing with mass. Shape (b, 3, N)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: N/m, N s/m. Shape (b, 3) each."""
    error: FloatArray
    """Strain-free displacement: of a pin off its nominal position, m. Shape (b, 3)."""

    @property
    def carried(self) -> BoolArray:
        """Whether each sits in a housing that moves, (b,)."""
        return np.asarray(np.any(self.seat != 0.0, axis=(1, 2)))

    def matrix(self, coefficient: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
        """Return left^T diag(coefficient) right for strains (b, 3, a) and (b, 3, c)."""
        return np.asarray(np.einsum("bki,bk,bkj->ij", left, coefficient, right))


def gather_supports(rotors: Bodies, seated: frozenset[str]) -> Supports:
    """Lay out the supports of all rotors; those `seated` have their springs in other arrays (`Seats`)."""
    on_ground: list[tuple[int, Bushing]] = [
        (i, bushing) for i, rotor in enumerate(rotors) for bushing in rotor.bushings
    ]
    on_pins = [(i, bearing) for i, rotor in enumerate(rotors) for bearing in rotor.planet_bearings]
    placed: list[tuple[int, Bushing | PlanetBearing]] = [*on_ground, *on_pins]
    parts = [part for _, part in placed]
    rows = [seat_motion(rotors, index, part)[:3] for index, part in placed]
    seats = [carried_seat(rotors, part.name)[:3] for part in parts]
    errors = [seat_error(rotors, index, part)[:3] for index, part in placed]
    stiffness = [[p.radial_stiffness, p.radial_stiffness, p.axial_stiffness] for p in parts]
    damping = [[p.radial_damping or 0.0, p.radial_damping or 0.0, p.axial_damping or 0.0] for p in parts]
    for row, part in enumerate(parts):
        if part.name in seated:
            stiffness[row], damping[row] = [0.0] * 3, [0.0] * 3
    return Supports(
        name=tuple(part.name for part in parts),
        frame=(*(rotors[index].frame for index, _ in on_ground), *(None for _ in on_pins)),
        motion=np.array(rows).reshape(-1, 3, column_count(rotors)),
        seat=np.array(seats).reshape(-1, 3, column_count(rotors)),
        stiffness=np.array(stiffness).reshape(-1, 3),
        damping=np.array(damping).reshape(-1, 3),
        error=np.array(errors).reshape(-1, 3),
    )
