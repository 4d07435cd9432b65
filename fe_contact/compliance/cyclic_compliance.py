"""From a gear to its flank compliance over the face width: mesh, condense a sector, close the ring, check."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg import blas

from fe_contact.compliance.cache import (
    KEPT_KEYS,
    content_hash,
    kept_or_computed,
    kept_size,
    mesher_version,
    once_each,
)
from fe_contact.compliance.elimination_tree import EliminationTree, sector_tree
from fe_contact.compliance.flank import FlankCompliance3D, refuse_broken_laws
from fe_contact.errors import integer
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.quad_sector import quad_sector, sector_outline
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport, bore_support
from fe_contact.mesh.swept_sector import swept_sector
from fe_contact.types import Json
from host import cpu_seconds
from model_studies.host_speed import kept_speed
from model_studies.progress import Report, by_cost, unreported
from model_studies.stage_clock import StageClock

# The distance of teeth whose flanks can carry load at once.


def usual_reach(gear: Toothing) -> int:
    """Return the largest distance of two teeth that can carry load at once.

    That is the length of the involute and the lead of the helix over the face, in base pitches.
    """
    across = abs(math.tan(gear.base_helix_angle)) * gear.face_width
    length = abs(gear.tip_roll_length - gear.form_roll_length) + across
    return min(max(1, math.ceil(length / gear.base_pitch)), gear.teeth // 2)


# Prediction of the cost of a three-dimensional flank compliance.


RANK_SHARE = 0.23  # flank loads that are solved for over flank freedoms, at most; measured 0.22 to 0.24
RANK, RANK_FACE = 45.0, 6.0  # the same of fine meshes: so many and so many for each module of the face
SPACE = 2.2  # dimension of the space of solutions over loads; measured 2.0 to 2.5
SOLVED = 6  # harmonics solved on all freedoms of a cut; more on thin rims
MESH_SECONDS = 0.08  # the transverse section
# Measured against the dense rate, on gears of 20 to 80 teeth from draft to fine:
FRONTS = 1.2  # time of the fronts over that of their operations at the dense rate
GATHERING = 110.0  # gathering one number of a front costs as much as so many multiplications with addition
ELEMENT = 4e6  # one element matrix, likewise
CHECKED = 130.0  # one number of a factor that the checks pass over, likewise
KEEPING = 1000.0  # one number of the result that is hashed, written and mirrored, likewise
RING_LOSS = 1.6  # time of the ring's steps over that of their operations at the dense rate
NUMBER = 8  # bytes
_RATES = (1e6, 1e15)
"""Multiplications with addition per second that a host may have."""


class PredictedCost(NamedTuple):
    """CPU seconds on one thread by part, in the order of the work, and bytes of the largest working set."""

    parts: Mapping[str, float]
    bytes: int

    @property
    def seconds(self) -> float:
        """CPU seconds of all parts."""
        return sum(self.parts.values())


class _SectorSizes(NamedTuple):
    """Numbers that the cost follows from.

    Freedoms of the flank, of one cut and of a keyed bore, harmonics, the largest distance of teeth that is
    kept, different element matrices, and the face width in modules.
    """

    flank: int
    cut: int
    key: int
    harmonics: int
    reach: int
    matrices: int
    face: float

    @property
    def loads(self) -> float:
        """Loads that the ring is solved for."""
        return min(RANK_SHARE * self.flank, RANK + RANK_FACE * self.face) + self.key

    @property
    def space(self) -> float:
        """Dimension of the space of the cuts."""
        return min(SPACE * self.loads, 0.75 * self.cut)


def predict_cost(
    gear: Toothing,
    recipe: SectorRecipe | None = None,
    cache: Path | None = None,
) -> PredictedCost:
    """Predict what `flank_compliance_3d` costs for a gear that is not in the cache, by its shape alone.

    Parameters
    ----------
    recipe : SectorRecipe, optional
        Default `SectorRecipe.standard(gear)`.
    cache : Path, optional
        Directory of what is known of the host.
    """
    return _predicted(gear.unmodified(), recipe or SectorRecipe.standard(gear), cache)


@lru_cache(maxsize=64)
def _predicted(gear: Toothing, recipe: SectorRecipe, cache: Path | None) -> PredictedCost:
    grid = sector_outline(tooth_profile(gear), recipe).grid
    sector = swept_sector(grid, gear.face_width, recipe, bore_support(gear), gear.web)
    tree = sector_tree(sector)
    matrices = sum(len(batch.quads) for batch in sector.batches)
    harmonics, reach = gear.teeth // 2 + 1, usual_reach(gear)
    key = len(sector.key_bore) + len(sector.key_cut)
    face = gear.face_width / gear.normal_module
    sizes = _SectorSizes(len(sector.loaded), len(sector.left), key, harmonics, reach, matrices, face)
    answers = float(gear.teeth * sizes.cut * key)  # of all cuts to forces on the bore
    operations = {
        "condensation": FRONTS * tree.operations + GATHERING * tree.front_entries + ELEMENT * sizes.matrices,
        "ring": RING_LOSS * _ring_operations(sizes),
        "checks": CHECKED * tree.factor_entries,
        "key": 2.0 * answers * sizes.flank,
        "keeping": KEEPING * (reach + 1) * sizes.flank**2,
    }
    keyed = int(NUMBER * (5.0 * answers + gear.teeth * sizes.flank * key))
    rate = kept_speed(cache, "dense_rate", _dense_rate, _RATES)
    seconds = {part: count / rate for part, count in operations.items()}
    return PredictedCost({"mesh": MESH_SECONDS} | seconds, _working_bytes(tree, sizes) + keyed)


def _ring_operations(sizes: _SectorSizes) -> float:
    """Return the multiplications with addition of holding the sector and closing the ring."""
    nf, nc, loads, space = float(sizes.flank), float(sizes.cut), sizes.loads, sizes.space
    holding = 0.5 * nf**3 + 2.0 * nf**2 * nc + 2.0 * nf * nc**2
    scaling = 1.2 * nc**3 + nf * nc**2 + nf**2 * nc
    solved = 4.0 * (nc**3 / 6.0 + nc**2 * loads) + 2.0 * nc * loads * (space + 2.0 * loads)
    within = 2.0 * nc * space * (nc + nf)
    harmonic = 4.0 * (space**3 / 6.0 + space**2 * loads)
    summing = 20.0 * (sizes.reach + 1) * space * loads
    back = (2 * sizes.reach + 1) * 2.0 * nf * space * loads + (sizes.reach + 1) * 2.0 * nf**2 * loads
    whole = min(SOLVED, sizes.harmonics) * solved + sizes.harmonics * (harmonic + summing)
    return holding + scaling + within + whole + back


def _working_bytes(tree: EliminationTree, sizes: _SectorSizes) -> int:
    """Return the bytes of the largest working set: factorizing, holding the flank, closing the ring."""
    nf, nc, loads, space = sizes.flank, sizes.cut, sizes.loads, sizes.space
    kept = 3600 * sizes.matrices + tree.factor_entries
    held = nf**2 + 4 * nc**2 + 2 * nf * nc
    scaled = 2 * nf * nc + 2 * nc**2
    summed = 2 * (sizes.reach + 1 + sizes.harmonics) * space * loads
    blocks = (sizes.reach + 2) * nf**2 + 2 * sizes.reach * nf * loads
    ring = held + scaled + max(5 * nc**2 + 4 * nc * loads, summed + blocks)
    return int(NUMBER * (kept + max(tree.working_entries(), (nf + 2 * nc) ** 2 + held, ring)))


@lru_cache(maxsize=1)
def _dense_rate() -> float:
    """Return multiplications with addition per CPU second of a symmetric update."""
    count, depth = 600, 300
    panel = np.asfortranarray(np.sin(np.arange(count * depth, dtype=float)).reshape(count, depth))
    times = []
    for _ in range(5):
        start = cpu_seconds()
        blas.dsyrk(1.0, panel, lower=1)
        times.append(cpu_seconds() - start)
    return 0.5 * count * (count + 1) * depth / max(float(np.median(times)), 1e-6)


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
    recipe, support = recipe or SectorRecipe.standard(gear), support or bore_support(gear.right_handed())
    reach = usual_reach(gear) if reach is None else integer("reach", reach, 0, gear.teeth // 2)
    key = compliance_key_3d(gear, recipe, reach, support)
    right = gear.right_handed()
    result = kept_or_computed(
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
        key: 0.0 if kept_size(cache, key) else predict_cost(gear.right_handed(), recipe, cache=cache).seconds
        for key, gear, recipe in zip(keys, gears, recipes, strict=True)
    }
    progress = by_cost(report, costs)
    compliances = once_each(
        keys,
        lambda i: flank_compliance_3d(
            gears[i], recipes[i], support=support, cache=cache, report=partial(progress, keys[i])
        ),
    )
    return tuple(
        each if each.base_helix_angle * gear.helix_angle >= 0.0 else each.mirrored()
        for gear, each in zip(gears, compliances, strict=True)
    )


def compliance_key_3d(gear: Toothing, recipe: SectorRecipe, reach: int, support: BoreSupport) -> str:
    """Return the hash of all that decides a compliance but for the hand of the helix."""
    return _key(gear, recipe, reach, support.name, MODEL_VERSION)


@lru_cache(maxsize=KEPT_KEYS)
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
    from fe_contact.compliance.condensed_gear import condensed_gear, gear_checks  # noqa: PLC0415
    from fe_contact.compliance.keyed_bore import key_update  # noqa: PLC0415
    from fe_contact.compliance.sector_stiffness import twist  # noqa: PLC0415

    clock = StageClock(progress=by_cost(report, predict_cost(gear, recipe).parts))
    section = quad_sector(gear, recipe)
    clock.progress("mesh", 1.0)
    clock.finish("mesh")
    profile = tooth_profile(gear)
    solved, loads = condensed_gear(gear, section, recipe, reach, support, clock)
    lever = gear.base_radius * math.cos(gear.base_helix_angle)
    checks = gear_checks(solved, loads, lever, gear.held_radius)
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
        unknowns=gear.teeth * (solved.sector.size - solved.held.cut_size),
        seconds=clock.seconds,
        solver=SOLVER,
        **keyed,
    )
    return refuse_broken_laws(result)
