"""Meshes on exact tooth profiles, made by gmsh in a child process, checked for quality."""

from fe_contact.mesh.bore_support import ClampedBore, PlaneStrain, bore_support
from fe_contact.mesh.gear_mesh import GearMesh, mesh_ahead, mesh_gear
from fe_contact.mesh.quad_sector import QuadSector, quad_sector
from fe_contact.mesh.quality import QualityLimits, mesh_quality
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.mesh.swept_sector import SweptSector, swept_sector

__all__ = [
    "ClampedBore",
    "GearMesh",
    "MeshRecipe",
    "PlaneStrain",
    "QuadSector",
    "QualityLimits",
    "SectorRecipe",
    "SweptSector",
    "bore_support",
    "mesh_ahead",
    "mesh_gear",
    "mesh_quality",
    "quad_sector",
    "swept_sector",
]
