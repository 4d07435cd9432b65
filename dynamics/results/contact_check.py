"""Whether what a run left out about contact would have mattered: flanks that parted without a coast flank."""

from __future__ import annotations

import numpy as np

from dynamics.system.assemble import System
from dynamics.system.observation import static_deflections
from dynamics.types import FloatArray, Json


def contact_checks(
    system: System, position: FloatArray, deflection: FloatArray, force: FloatArray
) -> list[Json]:
    """Return one entry per mesh that ran without backlash, from series (m, T) of its driving flank.

    ``parted`` is the share of the samples out of contact, ``widest_gap`` in m how far flanks were apart along
    the line of action, ``holds`` whether leaving the coast flank out changed nothing: none parted, or the gap
    stayed below a backlash that is given.
    """
    found: list[Json] = []
    for index, mesh in enumerate(system.scene.meshes):
        if system.ledger.on("backlash", mesh.name):
            continue
        apart = force[index] <= 0.0
        touch = np.empty(position.shape[1])
        static_deflections(system.arrays.elements.laws.flank.table, index, position[index], 0.0, touch)
        gap = float(np.max((touch - deflection[index])[apart], initial=0.0))
        room = mesh.coast.backlash if mesh.coast is not None else 0.0
        found.append(
            {
                "effect": "backlash",
                "part": mesh.name,
                "holds": bool(gap <= room),
                "parted": float(np.mean(apart)),
                "widest_gap": gap,
                "reason": _reason(gap, mesh.coast is not None, room),
            }
        )
    return found


def _reason(gap: float, known: bool, room: float) -> str:
    """In words."""
    if gap == 0.0:
        return "the driving flanks stayed in contact"
    if known and gap <= room:
        return "the flanks parted by less than the backlash: the coast flank was not reached"
    if known:
        return "the flanks parted by more than the backlash: switch the effect on"
    return "the flanks parted: right only if the backlash is wider than that; give the mesh its coast flank"
