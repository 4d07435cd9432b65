"""Meshes: gmsh triangles on exact tooth profiles, made in a child process, checked for quality."""

from fe_contact.mesh.gear_mesh import FlankNodes, GearMesh
from fe_contact.mesh.meshing import mesh_gear
from fe_contact.mesh.quality import MeshQuality, QualityLimits, mesh_quality
from fe_contact.mesh.recipe import MeshRecipe

__all__ = [
    "FlankNodes",
    "GearMesh",
    "MeshQuality",
    "MeshRecipe",
    "QualityLimits",
    "mesh_gear",
    "mesh_quality",
]
