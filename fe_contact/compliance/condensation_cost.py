"""Prediction of the cost of a three-dimensional flank compliance.

The sector of a tooth is condensed to its flank and to its two cuts, the faces to the neighboring sectors.
Then the flank is held, the ring of all sectors is closed harmonic by harmonic, and the displacements are
summed.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fe_contact.compliance.elimination_tree import EliminationTree, sector_tree
from fe_contact.compliance.tooth_reach import usual_reach
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.bore_support import bore_support
from fe_contact.mesh.sector_outline import sector_outline
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.mesh.swept_sector import swept_sector
from host.optional_modules import linalg
from model_studies.host_speed import algebra_threads, cached_speed, quickest

RANK_SHARE = 0.23  # most flank loads that the ring is solved for, over flank freedoms; measured 0.22 to 0.24

RANK, RANK_FACE = 45.0, 6.0  # most flank loads on fine meshes: `RANK`, and `RANK_FACE` per module of the face

SPACE = 2.2  # dimension of the space of solutions over loads; measured 2.0 to 2.5

SOLVED = 6  # harmonics solved on all freedoms of a cut; more on thin rims

MESH_SECONDS = 0.08  # the transverse section

# Measured against the dense rate, on gears of 20 to 80 teeth from draft to fine:
FRONTS = 1.2  # time of the fronts over that of their operations at the dense rate

GATHERING = 110.0  # gathering one number of a front costs as much as so many multiplications with addition

ELEMENT = 4e6  # one element matrix, likewise

CHECKED = 130.0  # one number of a factor that the checks pass over, likewise

KEEPING = 1000.0  # one number of the result in the cache: hashed, written and mirrored, likewise

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
    gear: Toothing, recipe: SectorRecipe | None = None, cache: Path | None = None
) -> PredictedCost:
    """Predict what `flank_compliance_3d` costs for a gear that is not in the cache, by its shape alone.

    Parameters
    ----------
    recipe : SectorRecipe, optional
        Default `SectorRecipe.standard(gear)`.
    cache : Path, optional
        Directory of what is known of the host.
    """
    operations, working_bytes = _counted(gear.unmodified(), recipe or SectorRecipe.standard(gear))
    rate = cached_speed(cache, f"dense_rate_{algebra_threads()}_threads", _dense_rate, _RATES)
    seconds = {part: count / rate for part, count in operations.items()}
    return PredictedCost({"mesh": MESH_SECONDS} | seconds, working_bytes)


@lru_cache(maxsize=64)
def _counted(gear: Toothing, recipe: SectorRecipe) -> tuple[Mapping[str, float], int]:
    """Return the multiplications with addition by part, and the bytes of the largest working set.

    They do not depend on the host, and serve the plan of a run as well as its progress.
    """
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
    return operations, _working_bytes(tree, sizes) + keyed


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
    by_harmonics = min(SOLVED, sizes.harmonics) * solved + sizes.harmonics * (harmonic + summing)
    return holding + scaling + within + by_harmonics + back


def _working_bytes(tree: EliminationTree, sizes: _SectorSizes) -> int:
    """Return the bytes of the largest working set: factorizing, holding the flank, closing the ring."""
    nf, nc, loads, space = sizes.flank, sizes.cut, sizes.loads, sizes.space
    factors = 3600 * sizes.matrices + tree.factor_entries  # 60 freedoms of an element, squared
    sector = nf**2 + 4 * nc**2 + 2 * nf * nc
    scaled = 2 * nf * nc + 2 * nc**2
    summed = 2 * (sizes.reach + 1 + sizes.harmonics) * space * loads
    blocks = (sizes.reach + 2) * nf**2 + 2 * sizes.reach * nf * loads
    ring = sector + scaled + max(5 * nc**2 + 4 * nc * loads, summed + blocks)
    return int(NUMBER * (factors + max(tree.working_entries(), (nf + 2 * nc) ** 2 + sector, ring)))


@lru_cache(maxsize=1)
def _dense_rate() -> float:
    """Return multiplications with addition per CPU second of a symmetric update.

    The update is as large as that of a large front: in two threads a smaller one, of 600 rows, takes four
    times the CPU time of one thread, and a whole condensation hardly more.
    """
    count, depth = 1000, 300
    panel = np.asfortranarray(np.sin(np.arange(count * depth, dtype=float)).reshape(count, depth))
    seconds = quickest(lambda: linalg.blas.dsyrk(1.0, panel, lower=1))
    return 0.5 * count * (count + 1) * depth / max(seconds, 1e-6)
