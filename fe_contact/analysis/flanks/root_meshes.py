"""Meshes for the stress of the tooth roots, and coarser ones for its error."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fe_contact.compliance import PlaneHypothesis
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.planning.discretization import FaceDiscretization, PlaneDiscretization

FINER_LAND, FINER_DEPTH = 2, 2.0 / 3.0
"""Number of elements along the root, and element size in the depth below both flanks, over those of the
sectors of the contact.
"""


@dataclass(frozen=True)
class _PlaneRootMeshes:
    """Sections of both gears, driving gear first: the sections of the contact, and sections half as fine."""

    hypothesis: PlaneHypothesis
    recipes: tuple[MeshRecipe, MeshRecipe]
    coarse_recipes: tuple[MeshRecipe, MeshRecipe]

    remaining = 1.0 / 3.0
    """Error left over the difference of the two meshes: ratio two, second order."""


@dataclass(frozen=True)
class FaceRootMeshes:
    """Sectors of both gears, driving gear first: the sectors of the contact, finer at the root.

    The coarse ones are the contact's own, with layers of the next coarser mesh.
    """

    recipes: tuple[SectorRecipe, SectorRecipe]
    coarse_recipes: tuple[SectorRecipe, SectorRecipe]

    remaining = 0.8
    """Error left over the difference of the two meshes: ratio one and a half or more, second order."""


def root_meshes(made: PlaneDiscretization | FaceDiscretization) -> _PlaneRootMeshes | FaceRootMeshes:
    """Choose the meshes of the root stress for a contact discretized as `made`."""
    if isinstance(made, PlaneDiscretization):
        return _PlaneRootMeshes(made.hypothesis, made.recipes, made.coarse_recipes)
    first, second = (finer_root(recipe) for recipe in made.recipes)
    coarse = tuple(
        replace(recipe, layers=coarser.layers)
        for recipe, coarser in zip(made.recipes, made.coarse_recipes, strict=True)
    )
    return FaceRootMeshes((first, second), (coarse[0], coarse[1]))


def finer_root(recipe: SectorRecipe) -> SectorRecipe:
    """Return the recipe with a root fine enough for its stress; the flank stays as it is."""
    return replace(
        recipe,
        land_elements=FINER_LAND * recipe.land_elements,
        depth_size=FINER_DEPTH * recipe.depth_size,
    )
