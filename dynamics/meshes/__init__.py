"""Gear meshes: tables of the mesh force, their compiled look-up, flanks with backlash and in space."""

import host.analysis  # noqa: F401 (says what to install)
from dynamics.meshes.gear_mesh import CoastFlank, GearMesh
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table, straight_table

__all__ = [
    "CoastFlank",
    "GearMesh",
    "MeshTable",
    "PeriodicCurve",
    "stiffness_table",
    "straight_table",
]
