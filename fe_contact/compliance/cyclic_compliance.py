"""Flank compliance of a gear over the face width: mesh, condense a sector, close the ring, check."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache, partial
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
from fe_contact.compliance.condensation_cost import predict_cost
from fe_contact.compliance.flank import FlankCompliance3D, refuse_broken_laws
from fe_contact.compliance.front_memory import shared_factors
from fe_contact.compliance.tooth_reach import usual_reach
from fe_contact.errors import InputError, integer
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.bore_support import BoreSupport, bore_support
from fe_contact.mesh.quad_sector import quad_sector
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.types import Json
from model_studies.progress import Report, by_cost, unreported
from model_studies.stage_clock import StageClock

MODEL_VERSION = 5  # raise it whenever the same input gives another result: old cache files are then not found
SOLVER = "dense substructures and cyclic harmonics (LAPACK)"


def flank_compliance_3d(
    gear: Toothing,
    recipe: SectorRecipe | None = None,
    *,
    reach: int | None = None,
    support: BoreSupport | None = None,
    cache: Path | None = None,
    report: Report = unreported,
) -> FlankCompliance3D:
    """Return the compliance of the right flanks of a gear over its face width; all teeth are real.

    Gears of opposite hand are mirror images to the last bit: the left-hand one is made from the other.

    Parameters
    ----------
    gear : Gear
        Modification plays no part.
    recipe : SectorRecipe, optional
        Default `SectorRecipe.standard(gear)`.
    reach : int, optional
        Largest distance in teeth that is kept, from 0 to half the teeth; default `usual_reach`.
    support : BoreSupport, optional
        How the right-hand gear is held; default: clamped, or on the gear's seat.
    cache : Path, optional
        Directory of kept results (see `default_cache_directory`); None: neither read nor written.
    report : callable
        Called with the fraction done, by predicted cost.

    Raises
    ------
    InputError
        `reach` is out of its bounds.
    MeshError
        No acceptable mesh.
    SolveError
        The stiffness is singular, or the result breaks a law.
    """
    if gear.sector_teeth is not None:
        raise InputError("sector_teeth", gear.sector_teeth, "left out over the face", "Its rings are whole.")
    recipe, support = recipe or SectorRecipe.standard(gear), support or bore_support(gear.right_handed())
    reach = usual_reach(gear) if reach is None else integer("reach", reach, 0, gear.teeth // 2)
    key = compliance_key_3d(gear, recipe, reach, support)
    right = gear.right_handed()
    result = cached_or_computed(
        cache,
        key,
        FlankCompliance3D,
        lambda: compute_flank_compliance_3d(right, recipe, reach, support, report=report),
    )
    return result.mirrored() if gear.helix_angle < 0.0 else result


def flank_compliances_3d(
    gears: Sequence[Toothing],
    recipes: Sequence[SectorRecipe] | None = None,
    *,
    support: BoreSupport | None = None,
    cache: Path | None = None,
    report: Report = unreported,
) -> tuple[FlankCompliance3D, ...]:
    """Return the compliance of each gear; gears alike, or alike but for the hand, are computed once.

    Parameters are those of `flank_compliance_3d`, with one recipe per gear.
    """
    recipes = recipes or [SectorRecipe.standard(gear) for gear in gears]
    keys = [
        compliance_key_3d(gear, recipe, usual_reach(gear), support or bore_support(gear.right_handed()))
        for gear, recipe in zip(gears, recipes, strict=True)
    ]
    costs = {
        key: 0.0
        if cached_size(cache, key)
        else predict_cost(gear.right_handed(), recipe, cache=cache).seconds
        for key, gear, recipe in zip(keys, gears, recipes, strict=True)
    }
    # the largest one first: the others find room in its memory
    order = sorted(range(len(keys)), key=lambda i: -costs[keys[i]])
    sequence = [keys[i] for i in order]
    progress = by_cost(report, {key: costs[key] for key in sequence})

    def computed(place: int) -> FlankCompliance3D:
        i = order[place]
        done = partial(progress, keys[i])
        return flank_compliance_3d(gears[i], recipes[i], support=support, cache=cache, report=done)

    with shared_factors():
        compliances = dict(zip(sequence, computed_once(sequence, computed), strict=True))
    return tuple(
        compliance if compliance.base_helix_angle * gear.helix_angle >= 0.0 else compliance.mirrored()
        for gear, compliance in zip(gears, (compliances[key] for key in keys), strict=True)
    )


def compliance_key_3d(gear: Toothing, recipe: SectorRecipe, reach: int, support: BoreSupport) -> str:
    """Return the hash of all inputs of a compliance except the hand of the helix."""
    return _key(gear, recipe, reach, support.name, MODEL_VERSION)


@lru_cache(maxsize=CACHED_KEYS)
def _key(gear: Toothing, recipe: SectorRecipe, reach: int, support: str, version: int) -> str:
    """Hash them once: predictions ask for the same few keys again and again."""
    content: Json = {
        "model": ["cyclic sector", version],
        "gmsh": mesher_version(),
        "geometry": gear.right_handed().macro_geometry(),
        "material": [gear.material.youngs_modulus, gear.material.poissons_ratio],
        "recipe": recipe.content(),
        "reach": reach,
        "support": support,
        "solver": SOLVER,
    }
    return content_hash(content)


def compute_flank_compliance_3d(
    gear: Toothing, recipe: SectorRecipe, reach: int, support: BoreSupport, *, report: Report = unreported
) -> FlankCompliance3D:
    """Mesh, condense, close the ring and check; no cache. `report` is called with the fraction done."""
    # A cached result needs neither skfem nor numba.
    from fe_contact.compliance.condensed_gear import condensed_gear  # noqa: PLC0415
    from fe_contact.compliance.gear_checks import gear_checks  # noqa: PLC0415
    from fe_contact.compliance.keyed_bore import key_update  # noqa: PLC0415
    from fe_contact.compliance.sector_stiffness import twist  # noqa: PLC0415

    clock = StageClock(progress=by_cost(report, predict_cost(gear, recipe).parts))
    section = quad_sector(gear, recipe)
    clock.progress("mesh", 1.0)
    clock.finish("mesh")
    profile = tooth_profile(gear)
    solved, loads = condensed_gear(gear, section, recipe, reach, support, clock)
    lever = gear.base_radius * math.cos(gear.base_helix_angle)
    checks = gear_checks(solved, loads, lever, gear.seat_radius)
    clock.finish("checks")
    flank = len(solved.sector.flank)
    blocks = np.ascontiguousarray(solved.ring.blocks[:, :flank, :flank])
    blocks[0] = 0.5 * (blocks[0] + blocks[0].T)
    keyed: Json = {}
    if gear.seat.key is not None:
        key = key_update(gear, solved, twist(gear), 2 * reach)
        keyed = {"key_rows": key.rows, "key_core": key.core}
        clock.finish("key")
    result = FlankCompliance3D(
        s=section.s,
        z=solved.sector.layers.ends,
        index=solved.sector.flank_index,
        blocks=blocks,
        s_form=profile.s_form,
        s_tip=profile.s_tip,
        contact_modulus=gear.material.plane_strain_modulus,
        base_helix_angle=gear.base_helix_angle,
        teeth=gear.teeth,
        checks=checks,
        unknowns=gear.teeth * (solved.sector.size - solved.condensed.cut_size),
        seconds=clock.seconds,
        solver=SOLVER,
        **keyed,
    )
    return refuse_broken_laws(result)
