"""A bearing's five strains by the bodies: of the shaft against the ground, a seat of a housing, or a pin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.seat import SEAT
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, housing_columns, section, section_rows
from dynamics.mechanism.rotor import Rotor
from dynamics.types import FloatArray


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
    apart = rotors[index].center - rotors[_carrier_of(rotors[index], support)].center
    c, s = apart[:2] / np.hypot(apart[0], apart[1])
    turn = np.eye(SEAT)
    turn[:2, :2] = turn[3:, 3:] = [[c, s], [-s, c]]
    return turn


def seat_error(rotors: Sequence[Rotor], index: int, support: Bushing | PlanetBearing) -> FloatArray:
    """Return the strains at which a support exerts no force, (5,): of a pin off its nominal position, m."""
    if not isinstance(support, PlanetBearing):
        return np.zeros(SEAT)
    own = np.array([support.radial_error, support.tangential_error, 0.0, 0.0, 0.0])
    return np.asarray(seat_axes(rotors, index, support).T @ own)


def _carrier_of(rotor: Rotor, bearing: PlanetBearing) -> int:
    if rotor.carrier is None:
        raise ValueError(f"{bearing.name}: not on a planet")  # the scene's checks come first
    return rotor.carrier
