"""Meshes and slices of a run, in the plane or over the face width."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

from fe_contact.compliance import PlaneHypothesis
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.mesh.sector_recipe import HELICAL_BODY_LAYERS, wound
from fe_contact.types import Json

PLANE_REFINEMENT = {"draft": 0.6, "medium": 0.8, "standard": 1.0, "fine": 2.0}
"""Refinement of plane meshes by level, over the standard one."""

SECTOR_RECIPE: dict[str, Callable[[Toothing], SectorRecipe]] = {
    "draft": SectorRecipe.draft,
    "medium": SectorRecipe.medium,
    "standard": SectorRecipe.standard,
    "fine": SectorRecipe.fine,
}

SLICES = 15
"""Slices of the face. False orders of helical pairs are then about 1 nm."""

FINER_SLICES = (23, 31)
"""Further numbers of slices that a tolerance may need."""

SLICE_ORDER = 2.3
"""Order of convergence of STE in the number of slices: 2.2 to 2.9 on helical pairs with 7 to 15 slices."""

SLICE_OVER_PATCH = 1.0
"""Least width of a slice over the half-width of the load patches. With narrower slices the compliance of the
bodies less that of the local law is not positive definite: heavy loads have no unique solution.
"""

COARSER = 1.5
"""Element size of the coarse mesh of a solid over that of its fine mesh."""

PLANE_RESOLVED, FACE_RESOLVED = 3.0, 1.5
"""Least number of elements in the half-width of a load patch. More elements make a wider patch, which spreads
a load over more of the flank than its contact strip: over the face, two elements change peak-to-peak by
1.3 %, one and a half by 0.3 %. Fewer elements raise the error of the mesh: in the plane, for drafts with one
and a half, to 0.1 % of the mean (docs/lab/index.md).
"""
PLANE_EDGE, FACE_EDGE = 1.5, 2.0
"""Least number of elements in the length of a patch at a tip edge."""


@dataclass(frozen=True)
class PlaneDiscretization:
    """Transverse sections."""

    hypothesis: PlaneHypothesis
    recipes: tuple[MeshRecipe, MeshRecipe]
    coarse_recipes: tuple[MeshRecipe, MeshRecipe]
    """`recipes`, `coarse_recipes`: Recipes of both gears; the coarse ones, half as fine, tell the error."""
    finite_width: tuple[SectorRecipe, SectorRecipe] | None = None
    """Recipes of solids of half the face for the correction of the finite width; None: the plane alone."""

    slices = 1
    remaining = 1.0 / 3.0
    """Error left over the difference of the two meshes: ratio two, second order or better."""
    coarse_slices = 1
    remaining_slices = 0.0
    resolved, resolved_edge = PLANE_RESOLVED, PLANE_EDGE  # elements in a patch, and in one at a tip edge

    def to_json(self) -> Json:
        """Return plain JSON."""
        plane = {"model": self.hypothesis.value, "mesh": [recipe.content() for recipe in self.recipes]}
        if self.finite_width is None:
            return plane
        return plane | {"finite_width": [recipe.content() for recipe in self.finite_width]}

    @property
    def corrected(self) -> bool:
        """Whether the plane is corrected for the finite width."""
        return self.finite_width is not None


@dataclass(frozen=True)
class FaceDiscretization:
    """Tooth sectors over the face width."""

    recipes: tuple[SectorRecipe, SectorRecipe]
    coarse_recipes: tuple[SectorRecipe, SectorRecipe]
    """`recipes`, `coarse_recipes`: Recipes of both gears; the coarse ones tell the discretization error."""
    slices: int
    """Number of slices of the common face width."""
    max_slices: int
    """Largest useful number of slices. Slices narrower than two thirds of a layer of either gear move the
    same freedoms of the bodies; `SLICE_OVER_PATCH` is a second limit.
    """

    corrected = False
    resolved, resolved_edge = FACE_RESOLVED, FACE_EDGE

    @property
    def remaining(self) -> float:
        """Error left over the difference of the two meshes: second order.

        Layers come in whole groups, so that the coarse mesh may have more of them than two thirds.
        """
        pairs = zip(self.recipes, self.coarse_recipes, strict=True)
        ratio = min(COARSER, *(fine.layers / coarse.layers for fine, coarse in pairs))
        return 1.0 / (ratio**2 - 1.0)

    def in_slices(self, count: int) -> FaceDiscretization:
        """Return the same meshes in another number of slices, or in `max_slices`."""
        return replace(self, slices=min(count, self.max_slices))

    @property
    def coarse_slices(self) -> int:
        """Half the slices."""
        return max(self.slices // 2, 1)

    @property
    def remaining_slices(self) -> float:
        """Error left over the difference to half the slices; no slices left out leave no error."""
        if self.slices == self.coarse_slices:
            return 0.0
        return 1.0 / (float((self.slices / self.coarse_slices) ** SLICE_ORDER) - 1.0)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"model": "3d", "mesh": [asdict(recipe) for recipe in self.recipes], "slices": self.slices}


Discretization = PlaneDiscretization | FaceDiscretization


def plane_discretization(
    pair: ParallelAxes, level: str, hypothesis: PlaneHypothesis, finite_width: bool = False
) -> PlaneDiscretization:
    """Choose the sections of both gears, and the solids that correct them for their finite width."""
    factor = PLANE_REFINEMENT[level]
    standard = (MeshRecipe.standard(pair.pinion), MeshRecipe.standard(pair.wheel))
    first, second = (recipe if factor == 1.0 else recipe.refined(factor) for recipe in standard)
    solids = None
    if finite_width:
        solids = SectorRecipe.even_load(pair.pinion), SectorRecipe.even_load(pair.wheel)
    return PlaneDiscretization(
        hypothesis,
        recipes=(first, second),
        coarse_recipes=(first.refined(0.5), second.refined(0.5)),
        finite_width=solids,
    )


def face_discretization(pair: ParallelAxes, level: str, slices: int | None = None) -> FaceDiscretization:
    """Choose the sectors of both gears and, unless they are given, the slices."""
    first, second = SECTOR_RECIPE[level](pair.pinion), SECTOR_RECIPE[level](pair.wheel)
    coarse = _coarser(first, pair.pinion), _coarser(second, pair.wheel)
    largest = min(_max_slices(pair, pair.pinion, first), _max_slices(pair, pair.wheel, second))
    return FaceDiscretization((first, second), coarse, min(slices or SLICES, largest), largest)


def _max_slices(pair: ParallelAxes, gear: Toothing, recipe: SectorRecipe) -> int:
    """Return the largest number of slices that a mesh resolves, by its layers and load patches."""
    layers = recipe.layers * pair.face_width / gear.face_width
    patches = pair.face_width / (FACE_RESOLVED * recipe.flank_size)
    return max(math.floor(min(1.5 * layers, patches / SLICE_OVER_PATCH) * (1.0 + 1e-9)), 1)


def _coarser(recipe: SectorRecipe, gear: Toothing) -> SectorRecipe:
    """Return the recipe with elements and layers one and a half times as large.

    Layers of a helical body are not merged where too few would be left.
    """
    larger = recipe.scaled(COARSER)
    few = wound(gear) and larger.layers < larger.layer_group * HELICAL_BODY_LAYERS
    return replace(larger, merge_rows=()) if few else larger
