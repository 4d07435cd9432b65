"""Meshes that resolve the contact strip, made once for all positions of a pair under one load."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.hertz.line_contact import contact_modulus, half_width
from fe_contact.mesh import GearMesh, MeshRecipe, mesh_gear

CORNER = 0.3  # base pitches by which loaded teeth touch beyond the path of contact
GROWTH = 0.4  # of the elements away from the flanks
BESIDE = 1  # real teeth beyond those that may touch, on either side


@dataclass(frozen=True)
class FullContactMesh:
    """Meshes of both gears.

    Attributes
    ----------
    gears : (GearMesh, GearMesh)
    reach : int
        Tooth pairs -reach ... reach may touch at positions from -0.5 to 0.5.
    """

    gears: tuple[GearMesh, GearMesh]
    reach: int

    @property
    def unknowns(self) -> int:
        """Displacements of all nodes."""
        return sum(2 * len(mesh.points) for mesh in self.gears)


def full_contact_mesh(
    pair: ParallelAxes, normal_force: float, elements_per_half_width: float = 1.5
) -> FullContactMesh:
    """Mesh both gears.

    Parameters
    ----------
    pair : GearPair
        External spur gears.
    normal_force : float
        N; decides the Hertz half-width at the pitch point.
    elements_per_half_width : float
        Quadratic elements along the flanks in that half-width; never coarser than the standard recipe.

    Raises
    ------
    MeshError
        gmsh failed, or an element misses its quality limit.
    """
    roll = pair.path_of_contact.pitch_point
    radius = 1.0 / float(pair.relative_curvature(roll))
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    size = float(half_width(normal_force / pair.face_width, radius, modulus)) / elements_per_half_width
    reach = reach_of(pair)
    teeth = 2 * (reach + BESIDE) + 1
    first = mesh_gear(pair.pinion, _recipe(pair.pinion, size, teeth))
    alike = pair.wheel.macro_geometry() == pair.pinion.macro_geometry()
    second = first if alike else mesh_gear(pair.wheel, _recipe(pair.wheel, size, teeth))
    return FullContactMesh((first, second), reach)


def reach_of(pair: ParallelAxes) -> int:
    """Return how many pairs beside the reference pair may touch, on either side, at -0.5 to 0.5."""
    path = pair.path_of_contact
    half = max(path.end - path.pitch_point, path.pitch_point - path.start) / pair.base_pitch
    return max(1, math.floor(half + CORNER + 0.5))


def _recipe(gear: Toothing, size: float, teeth: int) -> MeshRecipe:
    """Return the standard recipe with flanks and tip that resolve the strip, and few real teeth."""
    standard = MeshRecipe.standard(gear)
    flank = min(size, standard.flank_size)
    tip = min(standard.tip_size, flank)
    return replace(standard, flank_size=flank, tip_size=tip, growth=GROWTH, real_teeth=teeth)
