"""The flank of a gear in a file of REXS that carries."""

from __future__ import annotations

from rexs_stage import (
    STAGE,
)

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank, loaded_flank, meshing_of


def loaded(unit: GearUnit, gear: int, torque: float) -> LoadedFlank:
    """Return the loaded flank of a gear under a torque on the driver."""
    meshing = meshing_of(unit.part(STAGE), torques=(torque,))
    return loaded_flank(meshing, unit.part(gear))
