"""Supports as rows of springs: bushings to the ground and planet bearings to the carrier."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.joints import Bushing, PlanetBearing
from dynamics.system.planets import rigid_motion
from dynamics.system.rotor import Rotor
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Supports:
    """b supports, each three springs and dampers along x, y, z: bushings by rotor, then planet bearings.

    Attributes
    ----------
    name : tuple of str
    frame : tuple of int or None
        Rotor of the carrier whose turning frame the ground is seen from; None: forces are in the fixed frame
        as they are, or, of a planet bearing, stay in the carrier's.
    motion : (b, 3, 6 r) array
        Strain per freedom: displacement of the axis there, less that of the pin on a planet bearing.
    stiffness, damping : (b, 3) arrays
        N/m, N s/m.
    error : (b, 3) array
        Strain-free displacement: of a pin off its place, m.
    """

    name: tuple[str, ...]
    frame: tuple[int | None, ...]
    motion: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    error: FloatArray

    def matrix(self, coefficient: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
        """Return left^T diag(coefficient) right for strains (b, 3, a) and (b, 3, c)."""
        return np.asarray(np.einsum("bki,bk,bkj->ij", left, coefficient, right))


def gather_supports(rotors: Sequence[Rotor], seated: frozenset[str]) -> Supports:
    """Lay out the supports of all rotors; those `seated` have their springs elsewhere (`Seats`)."""
    on_ground: list[tuple[int, Bushing]] = [
        (i, bushing) for i, rotor in enumerate(rotors) for bushing in rotor.bushings
    ]
    on_pins = [(i, bearing) for i, rotor in enumerate(rotors) for bearing in rotor.planet_bearings]
    parts: list[Bushing | PlanetBearing] = [*(b for _, b in on_ground), *(b for _, b in on_pins)]
    rows = [_against_ground(rotors, index, bushing) for index, bushing in on_ground]
    rows += [_against_pin(rotors, index, bearing) for index, bearing in on_pins]
    errors = [np.zeros(3)] * len(on_ground) + [_pin_error(rotors, i, bearing) for i, bearing in on_pins]
    stiffness = [[p.radial_stiffness, p.radial_stiffness, p.axial_stiffness] for p in parts]
    damping = [[p.radial_damping or 0.0, p.radial_damping or 0.0, p.axial_damping or 0.0] for p in parts]
    for row, part in enumerate(parts):
        if part.name in seated:
            stiffness[row], damping[row] = [0.0] * 3, [0.0] * 3
    return Supports(
        tuple(part.name for part in parts),
        (*(rotors[index].frame for index, _ in on_ground), *(None for _ in on_pins)),
        np.array(rows).reshape(-1, 3, 6 * len(rotors)),
        np.array(stiffness).reshape(-1, 3),
        np.array(damping).reshape(-1, 3),
        np.array(errors).reshape(-1, 3),
    )


def _against_ground(rotors: Sequence[Rotor], index: int, bushing: Bushing) -> FloatArray:
    """Displacement of the axis at a bushing per freedom, (3, 6 r); rotation about the axis moves nothing."""
    row = np.zeros((3, 6 * len(rotors)))
    row[:, 6 * index : 6 * index + 6] = rigid_motion(np.array([0.0, 0.0, rotors[index].lever(bushing)]))
    return row


def _against_pin(rotors: Sequence[Rotor], index: int, bearing: PlanetBearing) -> FloatArray:
    """Displacement of the planet's axis less that of the pin, (3, 6 r)."""
    rotor, carrier = rotors[index], rotors[index].carrier
    if carrier is None:
        raise ValueError(f"{bearing.name}: not on a planet")  # the scene's checks come first
    row = np.zeros((3, 6 * len(rotors)))
    along = np.array([0.0, 0.0, rotor.lever(bearing)])
    row[:, 6 * index : 6 * index + 6] = rigid_motion(along)
    arm = rotor.center + along - rotors[carrier].center
    row[:, 6 * carrier : 6 * carrier + 6] -= rigid_motion(arm)
    return row


def _pin_error(rotors: Sequence[Rotor], index: int, bearing: PlanetBearing) -> FloatArray:
    """How far the pin is off its place, x, y, z in the carrier's frame, m."""
    carrier = rotors[index].carrier
    away = rotors[index].center - rotors[carrier if carrier is not None else index].center
    away = away * np.array([1.0, 1.0, 0.0]) / float(np.hypot(away[0], away[1]))
    across = np.array([-away[1], away[0], 0.0])
    return np.asarray(bearing.radial_error * away + bearing.tangential_error * across)
