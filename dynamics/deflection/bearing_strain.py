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
from dynamics.mechanism.supports import housed_seat, seat_motion
from dynamics.types import FloatArray

HALVINGS = 50  # bisections that find the clearance
FREE = 1e-12
"""Force over that at the whole displacement, up to which an element exerts no force."""


def _free_fraction(arrays: SystemArrays, element: int, coordinate: FloatArray) -> float:
    """Return the largest fraction of `coordinate` (p,) at which an element exerts no force; bisection."""
    local = make_local(arrays.elements, meshes=arrays.position_gradient.shape[0])
    rows = slice(arrays.elements.first[element], arrays.elements.first[element + 1])
    system, state = by_address(arrays), by_address(local)

    def force(fraction: float) -> float:
        local.coordinate[rows] = fraction * coordinate
        _evaluate(system, state, element)
        return float(np.linalg.norm(local.force[rows]))

    limit = FREE * force(1.0)
    if force(0.0) > limit:  # preloaded: there is no clearance
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if force(middle) <= limit else (low, middle)
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
    """Split the displacements at the bearings into elasticity and clearance of the bearing, and its seat.

    Clearance is the largest fraction of an element's displacement, in the directions of the element and in
    the sense of the displacement, at which it does not press yet. If springs hold the bearing in these
    directions as well, the clearance is 0.

    Parameters
    ----------
    motion : (N,) array
        Displacements of all freedoms of all rotors.
    coordinate : (R,) array
        Local coordinates of the force elements at these displacements.
    """
    supports = supports_by_name(system.rotors)  # index of the rotor, and bearing
    names, rotors = system.supports.name, system.rotors
    relative = np.array([seat_motion(rotors, *supports[name]) @ motion for name in names]).reshape(-1, SEAT)
    # seats move with housings with mass, whose freedoms are in `motion`, and with massless ones
    with_mass = np.array([housed_seat(rotors, name) @ motion for name in names]).reshape(-1, SEAT)
    total = relative + with_mass
    seat = with_mass + _condensed_seats(system, total)
    in_bearing, clearance, elements = total - seat, np.zeros_like(total), system.arrays.elements
    # the elements of bearings that are not linear are the last ones
    for e, bearing in enumerate(system.bearings, start=len(system.elements) - len(system.bearings)):
        projector = np.linalg.pinv(bearing.directions) @ bearing.directions  # onto the element's directions
        _, support = supports[names[bearing.support]]
        if np.any(np.abs(support.seat_stiffness @ projector) > 0.0):
            continue
        rows = slice(elements.first[e], elements.first[e + 1])
        free = _free_fraction(system.arrays, e, coordinate[rows])
        clearance[bearing.support] += free * projector @ in_bearing[bearing.support]
    return BearingStrain(elastic=in_bearing - clearance, clearance=clearance, seat=seat)


def _condensed_seats(system: System, total: FloatArray) -> FloatArray:
    """Return the motions (b, 5) of seats in massless housings, by the displacements `total` (b, 5).

    A massless housing rests in balance with the forces of its bearings at each moment.
    """
    supports, names = supports_by_name(system.rotors), list(system.supports.name)
    displacement = np.zeros_like(total)
    for housing in condensed_housings(system.scene, system.rotors):
        parts = [supports[name][1] for name in housing.bushings]
        indices = [names.index(name) for name in housing.bushings]
        stiffness = np.zeros((SEAT * len(indices), SEAT * len(indices)))
        for k, part in enumerate(parts):
            block = slice(SEAT * k, SEAT * k + SEAT)
            stiffness[block, block] = part.seat_stiffness
        preload = np.concatenate([part.preload or np.zeros(SEAT) for part in parts])
        force = stiffness @ total[indices].ravel() - preload
        displacement[indices] = (seat_compliance(housing, stiffness) @ force).reshape(-1, SEAT)
    return displacement
