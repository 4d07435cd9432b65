"""Displacements at the bearings: of the shaft, of the seat in the housing, and of the one in the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.deflection.clearance import clearance_of
from dynamics.joints.seat import SEAT
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.seat_motion import carried_seat, seat_motion
from dynamics.mechanism.seats import condensed_housings, seat_compliance
from dynamics.types import FloatArray


@dataclass(frozen=True)
class BearingStrain:
    """Displacements x, y, z (m), tilt_x, tilt_y (rad) at b bearings, each (b, 5); their sum is the shaft's.

    Of a planet bearing: of the planet against its pin.

    Attributes
    ----------
    elastic : (b, 5) array
        What the bearing yields under its load.
    clearance : (b, 5) array
        What it moves before anything presses back.
    seat : (b, 5) array
        Of its seat in an elastic housing.
    """

    elastic: FloatArray
    clearance: FloatArray
    seat: FloatArray

    @property
    def shaft(self) -> FloatArray:
        """Of the shaft's section in the bearing, (b, 5)."""
        return self.elastic + self.clearance + self.seat


def bearing_strain(system: System, motion: FloatArray, coordinate: FloatArray) -> BearingStrain:
    """Split the displacements at the bearings.

    Parameters
    ----------
    system : System
    motion : (N,) array
        All freedoms of all rotors.
    coordinate : (R,) array
        Local coordinates of the force elements there.
    """
    places = supports_by_name(system.rotors)
    names, rotors = system.supports.name, system.rotors
    strain = np.array([seat_motion(rotors, *places[name]) @ motion for name in names]).reshape(-1, SEAT)
    carried = np.array([carried_seat(rotors, name) @ motion for name in names]).reshape(-1, SEAT)
    total = strain + carried
    seat = carried + _condensed_seats(system, total)
    clearance = clearance_of(system, total - seat, coordinate)
    return BearingStrain(total - seat - clearance, clearance, seat)


def _condensed_seats(system: System, total: FloatArray) -> FloatArray:
    """Return the motions (b, 5) of the seats in housings that are no freedoms by the shafts' there (b, 5)."""
    places, names = supports_by_name(system.rotors), list(system.supports.name)
    moved = np.zeros_like(total)
    for housing in condensed_housings(system.scene, system.rotors):
        parts = [places[name][1] for name in housing.bushings]
        at = [names.index(name) for name in housing.bushings]
        stiffness = np.zeros((SEAT * len(at), SEAT * len(at)))
        for k, part in enumerate(parts):
            own = slice(SEAT * k, SEAT * k + SEAT)
            stiffness[own, own] = part.seat_stiffness
        preload = np.concatenate([part.preload or np.zeros(SEAT) for part in parts])
        pushed = stiffness @ total[at].ravel() - preload
        moved[at] = (seat_compliance(housing, stiffness) @ pushed).reshape(-1, SEAT)
    return moved
