"""Flank compliance of a gear in the transverse plane: mesh, assemble, condense, check."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from fe_contact.compliance.cache import (
    CACHED_KEYS,
    cached_or_computed,
    cached_size,
    computed_once,
    content_hash,
    mesher_version,
)
from fe_contact.compliance.condensed_sector import condense_sector
from fe_contact.compliance.factorization import FACTORIZATION
from fe_contact.compliance.flank import FlankCompliance, refuse_broken_laws
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.ring_2d import Ring, assemble_ring, flank_matrices
from fe_contact.compliance.ring_checks import ring_checks, uniform_pressure
from fe_contact.errors import InputError, integer
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh import GearMesh, MeshRecipe, mesh_ahead, mesh_gear
from fe_contact.types import IntArray, Json
from model_studies.stage_clock import StageClock

MODEL_VERSION = 5  # raise it whenever the same input gives another result: old cache files are then not found
USUAL_TEETH = 5
"""Number of condensed teeth unless another is requested."""


def flank_compliance(
    gear: Toothing,
    recipe: MeshRecipe | None = None,
    hypothesis: PlaneHypothesis = PlaneHypothesis.PLANE_STRAIN,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
) -> FlankCompliance:
    """Return the compliance of the right flanks of a gear, transverse section, per unit face width.

    Parameters
    ----------
    gear : Gear
        The modification has no influence. The face width has one only with a web, whose elements have its
        thickness over the face width (`docs/effects.md#thin_rim`).
    recipe : MeshRecipe, optional
        Default `MeshRecipe.standard(gear)`.
    teeth : int, optional
        Number of condensed teeth, odd, centered on tooth 0, at most those that the mesh has in full; default
        5, or as many as there are.
    cache : Path, optional
        Directory of stored results (see `default_cache_directory`); None: neither read nor written.

    Raises
    ------
    InputError
        `teeth` is even or exceeds the real teeth.
    MeshError
        No acceptable mesh.
    SolveError
        The matrix is singular, or the result breaks a law.
    """
    recipe = recipe or MeshRecipe.standard(gear)
    count = condensed_teeth(gear, recipe, teeth)
    key = compliance_key(gear, recipe, hypothesis, count)
    return cached_or_computed(
        cache, key, FlankCompliance, lambda: compute_flank_compliance(gear, recipe, hypothesis, count)
    )


def flank_compliances(
    gears: Sequence[Toothing],
    recipes: Sequence[MeshRecipe] | None = None,
    hypothesis: PlaneHypothesis = PlaneHypothesis.PLANE_STRAIN,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
    later: Sequence[MeshRecipe] | None = None,
) -> tuple[FlankCompliance, ...]:
    """Return the compliance of each gear; gears of the same section, material and recipe share one object.

    Parameters are those of `flank_compliance`, with one recipe per gear.

    later : sequence of MeshRecipe, optional
        Recipes of the same gears that the next call will have: one process meshes for both calls.
    """
    recipes = recipes or [MeshRecipe.standard(gear) for gear in gears]
    keys = section_keys(gears, recipes, hypothesis, teeth)
    later_keys = [] if later is None else section_keys(gears, later, hypothesis, teeth)
    sections = [*zip(gears, recipes, strict=True), *zip(gears, later or (), strict=later is not None)]
    first: dict[str, tuple[Toothing, MeshRecipe]] = {}
    for key, section in zip([*keys, *later_keys], sections, strict=True):
        first.setdefault(key, section)  # gears of the same section are meshed as the first of them
    mesh_ahead([section for key, section in first.items() if not cached_size(cache, key)])
    return computed_once(
        keys, lambda i: flank_compliance(gears[i], recipes[i], hypothesis, teeth=teeth, cache=cache)
    )


def section_keys(
    gears: Sequence[Toothing], recipes: Sequence[MeshRecipe], hypothesis: PlaneHypothesis, teeth: int | None
) -> list[str]:
    """Return the `compliance_key` of each gear."""
    return [
        compliance_key(gear, recipe, hypothesis, condensed_teeth(gear, recipe, teeth))
        for gear, recipe in zip(gears, recipes, strict=True)
    ]


def condensed_teeth(gear: Toothing, recipe: MeshRecipe, teeth: int | None) -> int:
    """Return the number of condensed teeth, checked against the teeth that the mesh has in full (real)."""
    whole = gear.teeth if gear.sector_teeth is None else gear.sector_teeth - 2  # cut planes carry no load
    real = min(whole, recipe.real_teeth or whole)
    limit = real - 1 + real % 2
    if teeth is None:
        return min(USUAL_TEETH, limit)
    if gear.sector_teeth is not None and teeth > limit:
        bound = f"{teeth + 2} or more, or left out"
        remedy = f"{teeth} teeth can touch, and one beside each cut plane carries no load."
        raise InputError("sector_teeth", gear.sector_teeth, bound, remedy)
    count = integer("teeth", teeth, 1, limit, "Condensed teeth must be real ones; see MeshRecipe.real_teeth.")
    if count % 2 == 0:
        raise InputError("teeth", teeth, "odd", "The teeth are centered on tooth 0.")
    return count


def compliance_key(gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int) -> str:
    """Return the hash of all inputs that determine a compliance of the transverse section."""
    return _key(gear, recipe, hypothesis, teeth, MODEL_VERSION)


@lru_cache(maxsize=CACHED_KEYS)
def _key(gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int, version: int) -> str:
    """Return the hash of `compliance_key`, cached since predictions need the same few keys repeatedly."""
    section = gear.macro_geometry()
    if gear.web is None:
        section.pop("face_width")
    content: Json = {
        "model": ["transverse section", version],
        "gmsh": mesher_version(),
        "section": section,
        "material": [gear.material.youngs_modulus, gear.material.poissons_ratio],
        "recipe": recipe.content(),
        "hypothesis": hypothesis.value,
        "teeth": teeth,
        "solver": FACTORIZATION,
    }
    return content_hash(content)


def compute_flank_compliance(
    gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int
) -> FlankCompliance:
    """Mesh, assemble, condense and check; no cache."""
    clock = StageClock()
    mesh = mesh_gear(gear, recipe)
    clock.finish("mesh")
    ring = condensed_ring(gear, mesh, hypothesis)
    clock.finish("factorisation")
    index = tooth_indices(mesh, teeth)
    matrix, along = flank_matrices(ring, index)
    clock.finish("condensation")
    profile = tooth_profile(gear)
    load = uniform_pressure(mesh.sector.s, profile.s_form, gear.base_radius)
    checks = ring_checks(ring, int(index[(teeth - 1) // 2]), load, matrix)
    clock.finish("checks")
    result = FlankCompliance(
        s=mesh.sector.s,
        teeth=mesh.teeth[index],
        matrix=0.5 * (matrix + matrix.T),
        along=along,
        s_form=profile.s_form,
        s_tip=profile.s_tip,
        contact_modulus=hypothesis.contact_modulus(gear.material),
        checks=checks,
        unknowns=2 * (len(mesh.points) - len(mesh.bore_nodes)),
        condensed_unknowns=ring.matrix.shape[0],
        seconds=clock.seconds,
        solver=FACTORIZATION,
    )
    return refuse_broken_laws(result)


def condensed_ring(gear: Toothing, mesh: GearMesh, hypothesis: PlaneHypothesis) -> Ring:
    """Assemble sector and hub, condense the sector, assemble and factorise the ring."""
    lame = hypothesis.lame_parameters(gear.material)
    normals = tooth_profile(gear).normal(mesh.sector.s)
    stiffness = stiffness_matrix(mesh.sector.points, mesh.sector.triangles, lame)
    sector = condense_sector(mesh, stiffness, normals)
    hub = None
    if mesh.hub is not None:
        hub = stiffness_matrix(mesh.hub.points, mesh.hub.triangles, lame, mesh.hub.thickness)
    return assemble_ring(mesh, sector, hub)


def tooth_indices(mesh: GearMesh, teeth: int) -> IntArray:
    """Return the positions of the `teeth` teeth around tooth 0 in `mesh.teeth`."""
    center = int(np.flatnonzero(mesh.teeth == 0)[0])
    return center + np.arange(teeth) - (teeth - 1) // 2
