"""Prediction of the cost of a three-dimensional flank compliance.

Operations and numbers held follow exactly from the elimination tree, which needs no mesh; the speed of dense
algebra is measured on the host, so that the prediction moves with the machine.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg import blas

from fe_contact.compliance.elimination_tree import EliminationTree
from fe_contact.compliance.sector_tree import sector_tree
from fe_contact.compliance.usual_reach import usual_reach
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.bore_support import bore_support
from fe_contact.mesh.sector_outline import sector_outline
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.mesh.swept_sector import SweptSector, swept_sector
from model_studies.host_speed import kept_speed

RANK_SHARE = 0.3  # of the flank freedoms that the cuts can tell apart; measured 0.28 to 0.38
MESH_SECONDS = 0.15  # gmsh's child process
# Measured against the dense rate, on gears of 20 to 80 teeth from draft to fine:
GATHERING = 100.0  # gathering one number of a front costs as much as so many multiplications with addition
ELEMENT = 1e6  # one element matrix, likewise
RING_LOSS = 1.3  # time of the ring's steps over that of their operations at the dense rate
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


class SectorSizes(NamedTuple):
    """Numbers that the cost follows from.

    Attributes
    ----------
    flank, cut : int
        Flank freedoms, and freedoms of one cut.
    harmonics, reach : int
        Harmonics to solve, and largest distance of teeth that is kept.
    matrices : int
        Different element matrices.
    """

    flank: int
    cut: int
    harmonics: int
    reach: int
    matrices: int


@lru_cache(maxsize=64)
def predict_cost(
    gear: Toothing,
    recipe: SectorRecipe | None = None,
    reach: int | None = None,
    cache: Path | None = None,
) -> PredictedCost:
    """Predict what `flank_compliance_3d` costs for a gear that is not in the cache.

    Parameters
    ----------
    gear : Gear
        The gear.
    recipe : SectorRecipe, optional
        Default `SectorRecipe.standard(gear)`.
    reach : int, optional
        Default `usual_reach(gear)`.
    cache : Path, optional
        Directory of what is known of the host.
    """
    recipe = recipe or SectorRecipe.standard(gear)
    grid = sector_outline(tooth_profile(gear), recipe).grid
    sector = swept_sector(grid, gear.face_width, recipe, bore_support(gear), gear.web)
    tree = sector_tree(sector)
    distance = usual_reach(gear) if reach is None else reach
    sizes = sector_sizes(sector, gear.teeth, distance)
    key = len(sector.key_bore) + len(sector.key_cut)
    answers = float(gear.teeth * sizes.cut * key)  # of all cuts to forces on the bore
    operations = {
        "condensation": tree.operations + GATHERING * tree.front_entries + ELEMENT * sizes.matrices,
        "ring": RING_LOSS * ring_operations(sizes) + sizes.harmonics * 4.0 * sizes.cut**2 * key,
        "checks": tree.factor_entries * GATHERING / 10.0,  # they pass twice over the factors
        "key": 2.0 * answers * sizes.flank,
    }
    keyed = int(NUMBER * (5.0 * answers + gear.teeth * sizes.flank * key))
    rate = kept_speed(cache, "dense_rate", dense_rate, _RATES)
    seconds = {part: count / rate for part, count in operations.items()}
    return PredictedCost({"mesh": MESH_SECONDS} | seconds, working_bytes(tree, sizes) + keyed)


def sector_sizes(sector: SweptSector, teeth: int, reach: int) -> SectorSizes:
    """Count what the cost follows from."""
    matrices = sum(len(batch.quads) for batch in sector.batches)
    return SectorSizes(len(sector.loaded), len(sector.left), teeth // 2 + 1, reach, matrices)


def ring_operations(sizes: SectorSizes) -> float:
    """Return the multiplications with addition of holding the sector and closing the ring."""
    nf, nc = float(sizes.flank), float(sizes.cut)
    rank = RANK_SHARE * nf
    holding = 0.5 * nf**3 + 2.0 * nf**2 * nc + 2.0 * nf * nc**2
    row_space = 2.0 * nf**2 * nc + 1.5 * nf**3
    harmonic = 4.0 * (nc**3 / 6.0 + nc**2 * rank)  # complex: four real ones
    summing = GATHERING / 10.0 * 2 * (sizes.reach + 1) * nc * rank
    back = (2 * sizes.reach + 1) * 2.0 * nf * nc * rank + (sizes.reach + 1) * 2.0 * nf**2 * rank
    return holding + row_space + sizes.harmonics * (harmonic + summing) + back


def working_bytes(tree: EliminationTree, sizes: SectorSizes) -> int:
    """Return the bytes of the largest working set: factorising fronts, or closing the ring."""
    nf, nc = sizes.flank, sizes.cut
    rank = RANK_SHARE * nf
    kept = 3600 * sizes.matrices + tree.factor_entries
    held = (nf + 2 * nc) ** 2 + nf**2 + 4 * nc**2 + 2 * nf * nc
    cuts = (2 * sizes.reach + 2) * nc * rank + 2 * nc * rank
    ring = (
        held + cuts + max(4 * nc**2 + 4 * nc * rank, (sizes.reach + 2) * nf**2 + 2 * sizes.reach * nf * rank)
    )
    return int(NUMBER * (kept + max(tree.working_entries(), ring)))


@lru_cache(maxsize=1)
def dense_rate() -> float:
    """Return multiplications with addition per CPU second of a symmetric update."""
    count, depth = 600, 300
    panel = np.asfortranarray(np.sin(np.arange(count * depth, dtype=float)).reshape(count, depth))
    times = []
    for _ in range(5):
        start = time.process_time()
        blas.dsyrk(1.0, panel, lower=1)
        times.append(time.process_time() - start)
    return 0.5 * count * (count + 1) * depth / max(min(times), 1e-6)
