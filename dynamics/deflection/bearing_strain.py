"""Displacements at bearings by cause: elasticity and clearance of the bearing, and motion of the seat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.bearings.seat import SEAT
from dynamics.forces.elements import evaluate, make_local
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.kernels.local_state import LocalState
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.connections import condensed_housings, seat_compliance
from dynamics.mechanism.supports import carried_seat, seat_motion
from dynamics.types import FloatArray

HALVINGS = 50  # bisections that find the clearance
FREE = 1e-12
"""Part of the force up to which an element does not press."""


def _free_fraction(arrays: SystemArrays, element: int, coordinate: FloatArray) -> float:
    """Return the largest fraction of `coordinate` (p,) at which an element exerts no force; bisection."""
    local = make_local(arrays.elements, arrays.position_gradient.shape[0])
    rows = slice(arrays.elements.first[element], arrays.elements.first[element + 1])
    system, at = by_address(arrays), by_address(local)

    def pressed(fraction: float) -> float:
        local.coordinate[rows] = fraction * coordinate
        _evaluate(system, at, element)
        return float(np.linalg.norm(local.force[rows]))

    limit = FREE * pressed(1.0)
    if pressed(0.0) > limit:
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pressed(middle) <= limit else (low, middle)
    return low


@compiled
def _evaluate(system: SystemArrays, local: LocalState, element: int) -> None:
    evaluate(system.elements, local, element)


@dataclass(frozen=True)
class BearingStrain:
    """Displacements x, y, z (m), tilt_x, tilt_y (rad) at b bearings, each (b, 5); their sum is the shaft's.

    Displacements at a planet bearing are those of the planet relative to its pin.
    """

    elastic: FloatArray
    """Elastic displacement in the bearing under its load. Shape (b, 5)."""
    clearance: FloatArray
    """Displacement through the clearance, before the bearing carries load. Shape (b, 5)."""
    seat: FloatArray
    """Displacement of the seat in an elastic housing. Shape (b, 5)."""

    @property
    def shaft(self) -> FloatArray:
        """Displacement of the shaft's section in the bearing, (b, 5)."""
        return self.elastic + self.clearance + self.seat


def bearing_strain(system: System, motion: FloatArray, coordinate: FloatArray) -> BearingStrain:
    """Split the displacements at the bearings.

    Clearance is the largest fraction of an element's displacement, in its own directions and in the sense in
    which it is displaced, at which it does not press yet. Where springs hold the bearing in these directions
    as well, there is none.

    Parameters
    ----------
    motion : (N,) array
        All freedoms of all rotors.
    coordinate : (R,) array
        Local coordinates of the force elements there.
    """
    supports = supports_by_name(system.rotors)
    names, rotors = system.supports.name, system.rotors
    strain = np.array([seat_motion(rotors, *supports[name]) @ motion for name in names]).reshape(-1, SEAT)
    carried = np.array([carried_seat(rotors, name) @ motion for name in names]).reshape(-1, SEAT)
    total = strain + carried
    seat = carried + _condensed_seats(system, total)
    yielded, clearance, elements = total - seat, np.zeros_like(total), system.arrays.elements
    for e, at in enumerate(system.bearings, start=len(system.elements) - len(system.bearings)):
        along = np.linalg.pinv(at.directions) @ at.directions
        if np.any(np.abs(supports[names[at.support]][1].seat_stiffness @ along) > 0.0):
            continue
        rows = slice(elements.first[e], elements.first[e + 1])
        free = _free_fraction(system.arrays, e, coordinate[rows])
        clearance[at.support] += free * along @ yielded[at.support]
    return BearingStrain(yielded - clearance, clearance, seat)


def _condensed_seats(system: System, total: FloatArray) -> FloatArray:
    """Return the motions (b, 5) of seats in massless housings by those of the shafts in them (b, 5)."""
    supports, names = supports_by_name(system.rotors), list(system.supports.name)
    displacement = np.zeros_like(total)
    for housing in condensed_housings(system.scene, system.rotors):
        parts = [supports[name][1] for name in housing.bushings]
        at = [names.index(name) for name in housing.bushings]
        stiffness = np.zeros((SEAT * len(at), SEAT * len(at)))
        for k, part in enumerate(parts):
            block = slice(SEAT * k, SEAT * k + SEAT)
            stiffness[block, block] = part.seat_stiffness
        preload = np.concatenate([part.preload or np.zeros(SEAT) for part in parts])
        pushed = stiffness @ total[at].ravel() - preload
        displacement[at] = (seat_compliance(housing, stiffness) @ pushed).reshape(-1, SEAT)
    return displacement
