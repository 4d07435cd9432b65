"""What a housing is by its solid: material, walls of the seats, settings of its reduction. Light: no mesh.

`dynamics.housing_modes` meshes and reduces it.
"""

from dynamics.solid_housing.file_suffixes import MESH_FORMATS, MESH_SUFFIXES, STEP_SUFFIXES
from dynamics.solid_housing.material import (
    CAST_ALUMINUM,
    GRAY_CAST_IRON,
    MATERIALS,
    SPHEROIDAL_CAST_IRON,
    Material,
)
from dynamics.solid_housing.mesh_content import check_mesh_content, mesh_text
from dynamics.solid_housing.reduction_settings import ELEMENT_SIZE, LOSS_FACTOR, MODES, ReductionSettings
from dynamics.solid_housing.seat_wall import BORE_DIAMETER, BORE_LENGTH, Ring, SeatWall

__all__ = [
    "BORE_DIAMETER",
    "BORE_LENGTH",
    "CAST_ALUMINUM",
    "ELEMENT_SIZE",
    "GRAY_CAST_IRON",
    "LOSS_FACTOR",
    "MATERIALS",
    "MESH_FORMATS",
    "MESH_SUFFIXES",
    "MODES",
    "SPHEROIDAL_CAST_IRON",
    "STEP_SUFFIXES",
    "Material",
    "ReductionSettings",
    "Ring",
    "SeatWall",
    "check_mesh_content",
    "mesh_text",
]
