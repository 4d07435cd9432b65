"""The strains of bearings over the freedoms of the bodies, and all bearings as rows of springs and dampers.

A support is a bearing of a rotor: a bushing to the ground or to a seat in a housing, or a planet's bearing on
a pin of the carrier. Its five strains are the displacements x, y, z and the tilts tilt_x, tilt_y of the
shaft's section less those of what holds it. N is the number of freedoms of all bodies, b of supports.
"""

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

TRANSLATIONS = 3
"""The first of the strains: the displacements x, y, z."""
RIGID = 6
"""Rigid freedoms of a rotor."""


def seat_motion(rotors: Bodies, index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the strains of a support of rotor `index` per freedom, (5, N): x, y, z, tilt_x, tilt_y.

    On a pin they are the motion of the planet's section less that of the pin, which is rigid with the
    carrier. In a housing with mass they are the motion of the shaft's section less that of the seat.
    """
    rotor = rotors[index]
    z = rotor.shaft.origin[2] + support.position
    rows = section_rows(rotors, index, z)[:SEAT]  # without the rotation about the axis
    if isinstance(support, PlanetBearing):
        carrier = _carrier_of(rotor, support)
        pin = section(rotors[carrier], np.array([*rotor.center[:2], z]))[:SEAT]
        rows[:, RIGID * carrier : RIGID * carrier + RIGID] -= pin
    return rows - housed_seat(rotors, support.name)


def housed_seat(rotors: Bodies, bearing: str) -> FloatArray:
    """Return the motion of a bearing's seat per freedom, (5, N); only a housing with mass moves its seats."""
    rows = np.zeros((SEAT, column_count(rotors)))
    housing = rotors.housing_of(bearing)
    if housing is not None:
        rows[:, housing_columns(rotors, housing)] = rotors.housings[housing].seat(bearing)
    return rows


def seat_axes(rotors: Sequence[Rotor], index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the matrix that turns strains along the scene's axes into the support's own axes, (5, 5).

    Of a planet bearing x points away from the carrier's axis and y along z x (away). The own axes of a
    bushing are those of the scene.
    """
    if not isinstance(support, PlanetBearing):
        return np.eye(SEAT)
    offset = rotors[index].center - rotors[_carrier_of(rotors[index], support)].center
    c, s = offset[:2] / np.hypot(offset[0], offset[1])
    in_plane = [[c, s], [-s, c]]
    rotation = np.eye(SEAT)
    rotation[:2, :2] = in_plane  # x, y
    rotation[3:, 3:] = in_plane  # tilt_x, tilt_y
    return rotation


def seat_error(rotors: Sequence[Rotor], index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the strains at which a support exerts no force, (5,), m: the position error of a pin, else 0."""
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
    """Arrays of b supports with springs and dampers along x, y, z: bushings first, then planet bearings.

    Both are in the order of their rotors. Tilts and cross terms are not among these springs.
    """

    name: tuple[str, ...]
    """Names of the bearings."""
    frame: tuple[int | None, ...]
    """Index of the carrier in whose rotating frame a bushing's rotor is described, so that the ground rotates
    in it. None: the rotor is described in the fixed frame, or the support is a planet bearing, whose forces
    act between two bodies of the carrier's frame.
    """
    motion: FloatArray
    """Strains x, y, z per freedom: displacement of the shaft's axis at the support, less that of the pin or
    of the seat in a housing with mass. Shape (b, 3, N).
    """
    seat: FloatArray
    """Displacement of the seat alone per freedom; zero unless in a housing with mass. Shape (b, 3, N)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Along x, y, z, in N/m and N s/m. Shape (b, 3) each."""
    error: FloatArray
    """Displacement without force: the position error of a pin, else 0, m. Shape (b, 3)."""

    @property
    def carried(self) -> BoolArray:
        """Whether the supports sit in a housing that moves, (b,)."""
        return np.asarray(np.any(self.seat != 0.0, axis=(1, 2)))

    def matrix(self, coefficient: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
        """Return left^T diag(coefficient) right, (i, j), for strains (b, 3, i) and (b, 3, j)."""
        return np.asarray(np.einsum("bki,bk,bkj->ij", left, coefficient, right))


def gather_supports(rotors: Bodies, general: frozenset[str]) -> Supports:
    """Return the arrays of the supports of all rotors.

    The springs of the bearings named in `general` are in other arrays (`Seats`); they are zero in these.
    """
    bushings: list[tuple[int, Bushing]] = [
        (index, bushing) for index, rotor in enumerate(rotors) for bushing in rotor.bushings
    ]
    on_pins = [(index, bearing) for index, rotor in enumerate(rotors) for bearing in rotor.planet_bearings]
    supports: list[tuple[int, Bushing | PlanetBearing]] = [*bushings, *on_pins]
    strains = [seat_motion(rotors, index, bearing)[:TRANSLATIONS] for index, bearing in supports]
    seats = [housed_seat(rotors, bearing.name)[:TRANSLATIONS] for _, bearing in supports]
    errors = [seat_error(rotors, index, bearing)[:TRANSLATIONS] for index, bearing in supports]
    stiffness, damping = [], []
    for _, bearing in supports:
        if bearing.name in general:
            stiffness.append([0.0, 0.0, 0.0])
            damping.append([0.0, 0.0, 0.0])
            continue
        # A damping that is None has not been filled in from the damping ratio yet, and counts as 0.
        radial, axial = bearing.radial_damping or 0.0, bearing.axial_damping or 0.0
        stiffness.append([bearing.radial_stiffness, bearing.radial_stiffness, bearing.axial_stiffness])
        damping.append([radial, radial, axial])
    # The shapes are given because there may be no support.
    return Supports(
        name=tuple(bearing.name for _, bearing in supports),
        frame=(*(rotors[index].frame for index, _ in bushings), *(None for _ in on_pins)),
        motion=np.array(strains).reshape(-1, TRANSLATIONS, column_count(rotors)),
        seat=np.array(seats).reshape(-1, TRANSLATIONS, column_count(rotors)),
        stiffness=np.array(stiffness).reshape(-1, TRANSLATIONS),
        damping=np.array(damping).reshape(-1, TRANSLATIONS),
        error=np.array(errors).reshape(-1, TRANSLATIONS),
    )
