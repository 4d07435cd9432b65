"""From a gear and a recipe to its checked mesh."""

from __future__ import annotations

from fe_contact.errors import MeshError
from fe_contact.geometry import Gear, ToothProfile, tooth_profile
from fe_contact.mesh.gear_mesh import GearMesh, assemble, real_teeth
from fe_contact.mesh.hub import Hub, hub, hub_outlines
from fe_contact.mesh.outline import Outline
from fe_contact.mesh.quadratic import QuadraticMesh, quadratic_mesh, region
from fe_contact.mesh.quality import QualityLimits, refuse_poor_elements
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.tooth_outline import tooth_outline
from fe_contact.mesh.tooth_sector import ToothSector, tooth_sector
from fe_contact.mesh.triangulation import triangulate
from fe_contact.types import IntArray

SLENDER = 3.0  # deepest sector down to the bore, in root circle pitches: beyond it a hub needs fewer elements
RIM_DEPTH = 2.0  # depth of a sector above a hub, in normal modules


def mesh_gear(
    gear: Gear, recipe: MeshRecipe | None = None, limits: QualityLimits | None = None, seconds: float = 60.0
) -> GearMesh:
    """Mesh the transverse section of one gear.

    Parameters
    ----------
    gear : Gear
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
    recipe = recipe or MeshRecipe.standard(gear)
    profile = tooth_profile(gear)
    teeth = real_teeth(gear.teeth, recipe.real_teeth)
    bottom_radius = sector_bottom(gear, profile, all_real=len(teeth) == gear.teeth)
    sector = mesh_sector(profile, bottom_radius, recipe, seconds)
    reaches_bore = bottom_radius == 0.5 * gear.bore_diameter
    rest = None if reaches_bore else mesh_hub(gear, sector, teeth, recipe, seconds)
    mesh = assemble(sector, rest, teeth, profile.pitch_angle, profile.normal(sector.s))
    # Copies of the sector are as good as the sector.
    refuse_poor_elements("tooth sector", sector.points, sector.triangles, limits or QualityLimits())
    if rest is not None:
        refuse_poor_elements("hub", rest.points, rest.triangles, limits or QualityLimits())
    return mesh


def sector_bottom(gear: Gear, profile: ToothProfile, all_real: bool) -> float:
    """Return the radius down to which a tooth sector reaches, m."""
    bore = 0.5 * gear.bore_diameter
    depth = gear.root_radius - bore
    if all_real and depth <= SLENDER * gear.root_radius * profile.pitch_angle:
        return bore
    return gear.root_radius - min(RIM_DEPTH * gear.normal_module, 0.5 * depth)


def mesh_sector(
    profile: ToothProfile, bottom_radius: float, recipe: MeshRecipe, seconds: float
) -> ToothSector:
    """Mesh one tooth and the ring below it down to `bottom_radius`."""
    outline = tooth_outline(profile, bottom_radius, recipe)
    mesh = _filled((outline.outline,), profile.gear.normal_module, recipe.growth, seconds)
    return tooth_sector(mesh, outline)


def mesh_hub(gear: Gear, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe, seconds: float) -> Hub:
    """Mesh the rest of the ring."""
    outlines = hub_outlines(gear, sector, teeth, recipe)
    return hub(_filled(outlines, gear.normal_module, recipe.growth, seconds), outlines, teeth)


def _filled(outlines: tuple[Outline, ...], scale: float, growth: float, seconds: float) -> QuadraticMesh:
    """Return the quadratic mesh inside outlines."""
    (straight,) = triangulate([region(outlines)], scale, growth, seconds)
    try:
        return quadratic_mesh(outlines, straight)
    except ValueError as error:
        raise MeshError(f"gmsh worker: {error}") from error
