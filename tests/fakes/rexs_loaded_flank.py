"""The flank of a gear in a file of REXS that carries."""

from __future__ import annotations

from rexs_stage import (
    STAGE,
)

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank, Meshing


def loaded(unit: GearUnit, gear: int, torque: float) -> LoadedFlank:
    """Return the loaded flank of a gear under a torque on the driver."""
    meshing = Meshing.of(unit.part(STAGE), torques=(torque,))
    return LoadedFlank.of(meshing, unit.part(gear))
