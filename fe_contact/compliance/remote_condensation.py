"""Gears condensed by workers, and their results in the cache of compliances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fe_contact.compliance.cache import cached_size, write_compliance
from fe_contact.compliance.cyclic_compliance import compliance_key_3d, compute_flank_compliance_3d
from fe_contact.compliance.flank import FlankCompliance3D
from fe_contact.compliance.tooth_reach import usual_reach
from fe_contact.geometry import Toothing
from fe_contact.mesh import SectorRecipe
from fe_contact.mesh.bore_support import BoreSupport, bore_support
from model_studies.progress import Report, unreported
from model_studies.workers import InProcess, Remembering, Workers, cluster_cached


@dataclass(frozen=True)
class _Solid:
    """A gear to be condensed over its face, of right hand."""

    gear: Toothing
    recipe: SectorRecipe
    reach: int
    support: BoreSupport

    @classmethod
    def of(cls, gear: Toothing, recipe: SectorRecipe) -> _Solid:
        right = gear.right_handed()
        return cls(right, recipe, usual_reach(gear), bore_support(right))

    @property
    def key(self) -> str:
        return compliance_key_3d(self.gear, self.recipe, self.reach, self.support)


def condensing(workers: Workers) -> Workers:
    """Return the workers that condense gears: those that do not remember results, which the cache holds."""
    return workers.others if isinstance(workers, Remembering) else workers


def condense_remotely(
    gears: Sequence[Toothing],
    recipes: Sequence[SectorRecipe],
    cache: Path,
    workers: Workers,
    report: Report = unreported,
) -> None:
    """Let workers condense the gears that are not in the cache, and keep them there.

    A cluster does each of them once, whoever asks. Nothing is done where this process is the worker.
    `report` is called with the fraction done after each gear.

    Raises `MeshError` or `SolveError` as `flank_compliance_3d`.
    """
    workers = condensing(workers)
    if isinstance(workers, InProcess):
        return
    solids = {solid.key: solid for solid in map(_Solid.of, gears, recipes)}
    missing = {key: solid for key, solid in solids.items() if not cached_size(cache, key)}
    if not missing:
        return
    compliances = workers.run(condense, None, list(missing.values()))
    for count, (key, compliance) in enumerate(zip(missing, compliances, strict=True), start=1):
        write_compliance(cache, key, compliance)
        report(count / len(missing))


@cluster_cached
def condense(_: None, solid: _Solid) -> FlankCompliance3D:
    """Condense a gear: one task."""
    return compute_flank_compliance_3d(solid.gear, solid.recipe, solid.reach, solid.support)
