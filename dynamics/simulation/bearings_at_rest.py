"""What rolling bearings carry where a run starts: force, and the heaviest of their elements."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.element_laws import Elements
from dynamics.forces.law import Law
from dynamics.forces.local_state import LocalState
from dynamics.integrators import static_equilibrium
from dynamics.joints import RollingBearing
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.motion.observation import local_state
from dynamics.rolling_bearings import LoadedBearing
from dynamics.rolling_bearings.row_law import row_law
from dynamics.types import Json

ROWS = (Law.BALLS, Law.ROLLERS)


def bearings_at_rest(system: System) -> Json:
    """Return ``{"rolling_bearings": {name: ...}}`` in the equilibrium under the loads at t = 0.

    Of each: ``displacement`` of the inner ring against the outer (m, rad), ``force`` of the shaft on the
    ground (N, N m), ``element_load`` of the heaviest element (N) and ``peak_pressure`` on it (Pa). Nothing
    without such bearings or without an equilibrium.
    """
    elements = system.arrays.elements
    rows = np.flatnonzero(np.isin(elements.law, ROWS))
    rest = static_equilibrium(system) if rows.size else None
    if rest is None or not rest.status.usable:
        return {}
    local = local_state(system.arrays, 0.0, rest.displacement, 0.0 * rest.displacement)
    bearings = {bearing.name: bearing for bearing in system.scene.rolling_bearings}
    first = elements.law.size - len(system.bearings)
    return {
        "rolling_bearings": {
            at.name: _carried(elements, local, e, at, bearings[at.name])
            for e, at in enumerate(system.bearings, start=first)
            if e in rows
        }
    }


def _carried(
    elements: Elements, local: LocalState, e: int, at: BearingElement, bearing: RollingBearing
) -> Json:
    """Return what the bearing of element `e` carries."""
    own, law, turned = slice(elements.first[e], elements.first[e + 1]), row_law(bearing), elements.mesh[e]
    moved = local.coordinate[own] / np.diag(at.own)
    moved[2] += law.shift
    angle = 2.0 * np.pi * float(local.position[turned]) if turned >= 0 else 0.0
    loaded = LoadedBearing(bearing.row, 1, bearing.locating) if turned >= 0 else law.loaded
    load = loaded.evaluate(moved, angle).load
    return {
        "displacement": moved.tolist(),
        "force": (local.force[own] @ at.own).tolist(),
        "element_load": float(np.max(load.sum(axis=1))),
        "peak_pressure": bearing.row.peak_pressure(float(np.max(load))),
    }
