"""Meshes and slices of a run, in the plane or over the face width."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

from fe_contact.compliance import PlaneHypothesis
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.types import Json

PLANE_REFINEMENT = {"draft": 0.6, "standard": 1.0, "fine": 2.0}
SECTOR_RECIPE: dict[str, Callable[[Toothing], SectorRecipe]] = {
    "draft": SectorRecipe.draft,
    "standard": SectorRecipe.standard,
    "fine": SectorRecipe.fine,
}
SLICES = 31
"""Fewer slices make false steps in helical gears (peak-to-peak 14 % off at 15 slices)."""


@dataclass(frozen=True)
class PlaneDiscretisation:
    """Transverse sections.

    Attributes
    ----------
    hypothesis : PlaneHypothesis
    recipes, coarse_recipes : (MeshRecipe, MeshRecipe)
        Driving and driven gear; the coarse ones are half as fine, for the discretisation error.
    """

    hypothesis: PlaneHypothesis
    recipes: tuple[MeshRecipe, MeshRecipe]
    coarse_recipes: tuple[MeshRecipe, MeshRecipe]

    slices = 1
    remaining = 1.0 / 3.0
    """Error left over the difference of the two meshes: ratio two, second order or better."""

    @property
    def least_patch(self) -> float:
        """Half-width in m that both meshes resolve: one and a half elements of the coarse one."""
        return 1.5 * max(recipe.flank_size for recipe in self.coarse_recipes)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"model": self.hypothesis.value, "mesh": [recipe.content() for recipe in self.recipes]}


@dataclass(frozen=True)
class FaceDiscretisation:
    """Tooth sectors over the face width.

    Attributes
    ----------
    recipes, coarse_recipes : (SectorRecipe, SectorRecipe)
        Driving and driven gear; the coarse ones for the discretisation error.
    slices : int
        Of the common face width.
    """

    recipes: tuple[SectorRecipe, SectorRecipe]
    coarse_recipes: tuple[SectorRecipe, SectorRecipe]
    slices: int

    remaining = 0.8
    """Error left over the difference of the two meshes: ratio one and a half, second order."""

    @property
    def least_patch(self) -> float:
        """Half-width in m that the mesh resolves along the profile and, as well as that, along the face."""
        return 2.0 * max(recipe.flank_size for recipe in self.recipes)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"model": "3d", "mesh": [asdict(recipe) for recipe in self.recipes], "slices": self.slices}


Discretisation = PlaneDiscretisation | FaceDiscretisation


def plane_discretisation(pair: ParallelAxes, level: str, hypothesis: PlaneHypothesis) -> PlaneDiscretisation:
    """Choose the sections of both gears."""
    factor = PLANE_REFINEMENT[level]
    standard = (MeshRecipe.standard(pair.pinion), MeshRecipe.standard(pair.wheel))
    first, second = (recipe if factor == 1.0 else recipe.refined(factor) for recipe in standard)
    return PlaneDiscretisation(hypothesis, (first, second), (first.refined(0.5), second.refined(0.5)))


def face_discretisation(pair: ParallelAxes, level: str) -> FaceDiscretisation:
    """Choose the sectors of both gears and the slices.

    A slice needs half a layer of its own, else the slices' forces move the same freedoms and the compliance
    between them is singular.
    """
    first, second = (SECTOR_RECIPE[level](gear) for gear in (pair.pinion, pair.wheel))
    slices = min(SLICES, *(2 * recipe.layers - 1 for recipe in (first, second)))
    return FaceDiscretisation((first, second), (_coarser(first), _coarser(second)), slices)


def _coarser(recipe: SectorRecipe) -> SectorRecipe:
    """Return the recipe with elements and layers one and a half times as large."""
    sizes = ("flank_size", "tip_size", "depth_size", "depth_limit", "body_size", "body_limit")
    group = recipe.layer_group
    layers = group * max(math.ceil(recipe.layers / 1.5 / group), 1)
    return replace(recipe, layers=layers, **{name: 1.5 * getattr(recipe, name) for name in sizes})
