"""Gear meshes: tables of the mesh force, their compiled look-up, flanks with backlash and in space."""

from dynamics.meshes.gear_mesh import CoastFlank, GearMesh
from dynamics.meshes.mesh_table import MeshTable

__all__ = [
    "CoastFlank",
    "GearMesh",
    "MeshTable",
]
