"""Gears of few teeth, and sectors of them that are meshed coarsely."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from fe_contact.compliance import FlankCompliance3D
from fe_contact.compliance.condensed_gear import probe_loads
from fe_contact.compliance.sector_stiffness import sector_stiffness
from fe_contact.geometry import Gear, GearBlank, Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe, quad_sector, swept_sector

SPUR = Gear(teeth=9, normal_module=4e-3, face_width=20e-3, bore_diameter=12e-3, profile_shift_coefficient=0.4)
HELICAL = replace(SPUR, helix_angle=math.radians(25.0))
WEBBED = replace(HELICAL, blank=GearBlank(3e-3, 6e-3, 14e-3, web_offset=3e-3))


def coarse(gear: Toothing, **fields: object) -> SectorRecipe:
    m = gear.normal_module
    recipe = SectorRecipe(
        flank_size=0.5 * m,
        tip_size=0.3 * m,
        depth_size=0.6 * m,
        depth_limit=0.9 * m,
        body_size=0.5 * m,
        body_limit=1.5 * m,
        layers=4,
        land_elements=1,
        merge_rows=(-1,),
    )
    return replace(recipe, **fields)


def coarse_plane(gear: Toothing, **fields: Any) -> MeshRecipe:
    """Return a recipe coarse enough for tests of laws that hold on every mesh."""
    m = gear.normal_module
    sizes = {"flank_size": 0.2 * m, "tip_size": 0.1 * m, "fillet_size": 0.2 * m}
    return replace(MeshRecipe.standard(gear), **(sizes | fields))


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    """Return the largest difference over the largest value."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def moved(compliance: FlankCompliance3D, tooth: int = 0) -> float:
    """Return the mean displacement (m/N) of a flank under an even pressure of unit force on tooth 0."""
    loads = probe_loads(compliance.s, compliance.z, compliance.index, compliance.s_form)[:, 0]
    return float(loads @ compliance.block(tooth, 0) @ loads / loads.sum() ** 2)


def whole_gear(gear: Toothing, recipe: SectorRecipe, support: Any = None) -> tuple[Any, Any, np.ndarray, Any]:
    """Return section, sector, the numbers of the freedoms of all teeth, and one sparse matrix of them."""
    section = quad_sector(gear, recipe)
    sector = swept_sector(section.grid, gear.face_width, recipe, support, gear.web)
    stiffness = sector_stiffness(gear, section, sector)
    number = np.full((gear.teeth, sector.size + 1), -1)  # the last column: what is held
    own = np.setdiff1d(np.arange(sector.size), sector.left)
    number[:, own] = np.arange(gear.teeth * len(own)).reshape(gear.teeth, -1)
    number[:, sector.left] = np.roll(number[:, sector.right], -1, axis=0)
    dofs = number[:, sector.element_freedoms]
    i, k = np.broadcast_arrays(dofs[..., :, None], dofs[..., None, :])
    free = (i >= 0) & (k >= 0)
    values = np.broadcast_to(stiffness.matrices[stiffness.of_element], i.shape)[free]
    return section, sector, number, sp.csc_array(sp.coo_array((values, (i[free], k[free]))))
