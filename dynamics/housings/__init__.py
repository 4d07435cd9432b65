"""Housings with mass: component mode synthesis of a finite-element mesh, or reduced matrices.

The only package of dynamics that uses scikit-fem, meshio, meshlane and, in a child process, gmsh.
"""

from dynamics.housings.cached_reduction import meshed_step, reduced_housing
from dynamics.housings.mesh_faces import Bore, BoundedPlane, Box, Group, Plane
from dynamics.housings.mesh_files import read_mesh
from dynamics.housings.meshed_housing import MaterialDamping, MeshedHousing, ModalDamping
from dynamics.housings.reduced_housing import ReducedHousing, receptance, scene_axes, scene_housing
from dynamics.housings.reduced_matrices import (
    ReducedMatrices,
    housing_of_matrices,
    read_matrix_market,
    read_reduced_matrices,
)
from dynamics.housings.reduction_cost import CostLimit, reduction_cost
from dynamics.housings.step_files import FlatFace, StepSolid, mesh_step, step_solid, usual_edge
from dynamics.housings.supports import Foot, Mount, SeatBore, SeatFrame
from dynamics.housings.surface_files import write_surface
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import GRAY_CAST_IRON, SPHEROIDAL_CAST_IRON, Material, Ring

__all__ = [
    "GRAY_CAST_IRON",
    "SPHEROIDAL_CAST_IRON",
    "Bore",
    "BoundedPlane",
    "Box",
    "CostLimit",
    "FlatFace",
    "Foot",
    "Group",
    "Material",
    "MaterialDamping",
    "MeshedHousing",
    "ModalDamping",
    "Mount",
    "Plane",
    "ReducedHousing",
    "ReducedMatrices",
    "Ring",
    "SeatBore",
    "SeatFrame",
    "StepSolid",
    "TetrahedralMesh",
    "housing_of_matrices",
    "mesh_step",
    "meshed_step",
    "read_matrix_market",
    "read_mesh",
    "read_reduced_matrices",
    "receptance",
    "reduced_housing",
    "reduction_cost",
    "scene_axes",
    "scene_housing",
    "step_solid",
    "usual_edge",
    "write_surface",
]
