"""From a gear and a recipe to its checked mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import Toothing, ToothProfile, tooth_profile
from fe_contact.mesh.gear_mesh import GearMesh, assemble, real_teeth
from fe_contact.mesh.hub import Hub, hub, hub_outline, inner_rings
from fe_contact.mesh.outline import Outline
from fe_contact.mesh.quadratic import QuadraticMesh, quadratic_mesh, region
from fe_contact.mesh.quality import QualityLimits, refuse_poor_elements
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.tooth_outline import tooth_outline
from fe_contact.mesh.tooth_sector import ToothSector, tooth_sector
from fe_contact.mesh.triangulation import triangulate
from fe_contact.types import IntArray

SLENDER = 3.0  # deepest sector down to the bore, in root circle pitches: beyond it a hub needs fewer elements
TAPER = 0.35  # least bore of sectors down to it, in root circles: below it a sector is a needle
RIM_DEPTH = 2.0  # depth of a sector above a hub, in normal modules


def mesh_gear(
    gear: Toothing,
    recipe: MeshRecipe | None = None,
    limits: QualityLimits | None = None,
    seconds: float = 60.0,
) -> GearMesh:
    """Mesh the transverse section of one gear.

    Parameters
    ----------
    gear : Gear or RingGear
        Its modification plays no part.
    recipe : MeshRecipe, optional
        Element sizes; default `MeshRecipe.standard(gear)`.
    limits : QualityLimits, optional
        Least acceptable element quality.
    seconds : float
        Time limit of gmsh, which runs in a child process.

    Raises
    ------
    MeshError
        gmsh failed, was killed or ran out of time, or an element misses its quality limit.
    """
    recipe, filling = recipe or MeshRecipe.standard(gear), Filling(limits or QualityLimits(), seconds)
    profile = tooth_profile(gear)
    teeth = real_teeth(gear.teeth, recipe.real_teeth)
    bottom_radius = _sector_bottom(gear, profile, all_real=len(teeth) == gear.teeth)
    sector = _mesh_sector(profile, bottom_radius, recipe, filling)
    rest = None if bottom_radius == gear.held_radius else _mesh_hub(gear, sector, teeth, recipe, filling)
    # Copies of the sector are as good as the sector, which is checked.
    return assemble(sector, rest, teeth, profile.pitch_angle, profile.normal(sector.s))


def _sector_bottom(gear: Toothing, profile: ToothProfile, all_real: bool) -> float:
    """Return the radius to which a tooth sector reaches, m."""
    depth = gear.rim_thickness
    slender = depth > SLENDER * gear.root_radius * profile.pitch_angle
    if gear.web is None and all_real and not slender and gear.held_radius >= TAPER * gear.root_radius:
        return gear.held_radius
    return gear.root_radius - gear.sign * min(RIM_DEPTH * gear.normal_module, 0.5 * depth)


@dataclass(frozen=True)
class Filling:
    """Limits on filling outlines with elements: quality, and time in s."""

    limits: QualityLimits
    seconds: float

    def mesh(self, part: str, outlines: tuple[Outline, ...], scale: float, growth: float) -> QuadraticMesh:
        """Return the checked mesh of `part` inside outlines; `scale` is a length of its size, m."""
        (straight,) = triangulate([region(outlines)], scale, growth, self.seconds)
        mesh = quadratic_mesh(outlines, straight)
        refuse_poor_elements(part, mesh.points, mesh.triangles, self.limits)
        return mesh


def _mesh_sector(
    profile: ToothProfile, bottom_radius: float, recipe: MeshRecipe, filling: Filling
) -> ToothSector:
    outline = tooth_outline(profile, bottom_radius, recipe)
    scale = profile.gear.normal_module
    return tooth_sector(filling.mesh("tooth sector", (outline.outline,), scale, recipe.growth), outline)


def _mesh_hub(
    gear: Toothing, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe, filling: Filling
) -> Hub:
    """Mesh the rest of the ring: of a solid gear in one piece, else what is left of the rim, web and hub."""
    toothed = hub_outline(gear, sector, teeth, recipe)
    rings = inner_rings(gear, float(np.linalg.norm(sector.points[sector.bottom[0]])), recipe)
    meshes, around = [], toothed
    for ring in rings:
        outermost_first = (around, ring.circle)[:: gear.sign]
        meshes.append(filling.mesh("hub", outermost_first, gear.normal_module, recipe.growth))
        around = ring.circle.reversed()
    return hub(meshes, toothed, [ring.thickness for ring in rings], teeth, gear.sign)
