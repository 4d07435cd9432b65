"""Housings with mass: component mode synthesis of a finite-element mesh, or reduced matrices.

The only package of dynamics that uses scikit-fem, meshlane and, in a child process, gmsh.
"""

import host.analysis  # noqa: F401 (says what to install)
from dynamics.housing_modes.damping import USUAL_DAMPING, MaterialDamping, ModalDamping
from dynamics.housing_modes.faces import Bore, BoundedPlane, Box, Group, Plane
from dynamics.housing_modes.feet import Foot, Mount
from dynamics.housing_modes.kept import CostLimit, meshed_step, reduced_housing, reduction_cost
from dynamics.housing_modes.mesh_file import read_mesh
from dynamics.housing_modes.meshed_housing import MeshedHousing
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.housing_modes.reduced_matrices import (
    ReducedMatrices,
    housing_of_matrices,
    read_matrix_market,
    read_reduced_matrices,
)
from dynamics.housing_modes.response import receptance
from dynamics.housing_modes.scene_housing import scene_housing
from dynamics.housing_modes.seats import SeatBore, SeatFrame
from dynamics.housing_modes.step_mesh import mesh_step
from dynamics.housing_modes.surface_file import write_surface
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import CAST_ALUMINUM, GRAY_CAST_IRON, SPHEROIDAL_CAST_IRON, Material, Ring

__all__ = [
    "CAST_ALUMINUM",
    "GRAY_CAST_IRON",
    "SPHEROIDAL_CAST_IRON",
    "USUAL_DAMPING",
    "Bore",
    "BoundedPlane",
    "Box",
    "CostLimit",
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
    "scene_housing",
    "write_surface",
]
