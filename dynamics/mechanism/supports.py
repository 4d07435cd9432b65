"""Supports as rows of springs: bushings to the ground and planet bearings to the carrier."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.bearings import Bushing, PlanetBearing
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.seat_motion import carried_seat, seat_error, seat_motion
from dynamics.types import BoolArray, FloatArray


@dataclass(frozen=True)
class Supports:
    """b supports, each three springs and dampers along x, y, z: bushings by rotor, then planet bearings.

    Attributes
    ----------
    name : tuple of str
    frame : tuple of int or None
        Rotor of the carrier whose rotating frame the ground is seen from; None: forces are in the fixed frame
        as they are, or, of a planet bearing, stay in the carrier's.
    motion : (b, 3, N) array
        Strain per freedom: displacement of the axis there, less that of the pin on a planet bearing, of the
        seat in a housing with mass.
    seat : (b, 3, N) array
        Of the seat alone: zero but in a housing with mass.
    stiffness, damping : (b, 3) arrays
        N/m, N s/m.
    error : (b, 3) array
        Strain-free displacement: of a pin off its nominal position, m.
    """

    name: tuple[str, ...]
    frame: tuple[int | None, ...]
    motion: FloatArray
    seat: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    error: FloatArray

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
        tuple(part.name for part in parts),
        (*(rotors[index].frame for index, _ in on_ground), *(None for _ in on_pins)),
        np.array(rows).reshape(-1, 3, column_count(rotors)),
        np.array(seats).reshape(-1, 3, column_count(rotors)),
        np.array(stiffness).reshape(-1, 3),
        np.array(damping).reshape(-1, 3),
        np.array(errors).reshape(-1, 3),
    )
