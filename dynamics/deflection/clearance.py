"""The part of a bearing's displacement that is clearance: what it moves before anything presses back."""

from __future__ import annotations

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.forces.by_address import by_address
from dynamics.forces.compiled import compiled
from dynamics.forces.element_laws import evaluate, make_local
from dynamics.forces.local_state import LocalState
from dynamics.types import FloatArray

HALVINGS = 50
FREE = 1e-12
"""Part of the force up to which an element does not press."""


def clearance_of(system: System, strain: FloatArray, coordinate: FloatArray) -> FloatArray:
    """Return the part (b, 5) of the bearings' strains (b, 5) that meets no force.

    The largest fraction of an element's displacement, in its own directions and in the sense in which it is
    displaced, at which it does not press yet. Where springs hold the bearing in these directions as well,
    there is no clearance.

    Parameters
    ----------
    system : System
    strain : (b, 5) array
        x, y, z, tilt_x, tilt_y of the shaft against what holds it, m and rad.
    coordinate : (R,) array
        Local coordinates of all elements at these strains.
    """
    elements, free = system.arrays.elements, np.zeros_like(strain)
    first = len(system.elements) - len(system.bearings)
    for e, at in enumerate(system.bearings, start=first):
        along = np.linalg.pinv(at.way) @ at.way
        if np.any(np.abs(_springs(system, at.support) @ along) > 0.0):
            continue
        rows = slice(elements.first[e], elements.first[e + 1])
        free[at.support] += _free_fraction(system.arrays, e, coordinate[rows]) * along @ strain[at.support]
    return free


def _springs(system: System, support: int) -> FloatArray:
    """Stiffness matrix (5, 5) of the linear part of a bearing."""
    known = {part.name: part for rotor in system.rotors for part in rotor.supports}
    return known[system.supports.name[support]].seat_stiffness


def _free_fraction(arrays: SystemArrays, element: int, coordinate: FloatArray) -> float:
    """Return the largest fraction of `coordinate` (p,) at which an element exerts no force; bisection."""
    local = make_local(arrays.elements, arrays.turn.shape[0])
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
    """Evaluate one element at its coordinates in `local`."""
    evaluate(system.elements, local, element)
