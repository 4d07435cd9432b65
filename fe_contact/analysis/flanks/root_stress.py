"""Tooth-root stress of a gear pair: unit-load stress of both gears times the forces of the solved contact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bounds import warn_of
from bounds.brief import brief
from fe_contact.analysis.flanks.root_meshes import FaceRootMeshes, root_meshes
from fe_contact.analysis.flanks.root_stress_history import ROOTS, RootStressHistory
from fe_contact.analysis.flanks.rougher_solutions import halves, rougher_solutions
from fe_contact.analysis.flanks.solved_operating_point import solved_point
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.compliance import (
    PlaneHypothesis,
    UnitRootStress,
    stress_cached,
    unit_root_stresses,
    unit_root_stresses_3d,
)
from fe_contact.contact import face_flank_forces, plane_flank_forces
from fe_contact.contact.patch import Patches
from fe_contact.geometry import ParallelAxes, tooth_profile
from fe_contact.geometry.root_tangent import critical_section
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from fe_contact.planning.cost_model import body_seconds
from fe_contact.planning.discretization import PlaneDiscretization
from fe_contact.planning.plan import Plan
from fe_contact.plausibility import root_findings, unexpected
from fe_contact.types import BoolArray, FloatArray, IntArray, Json
from model_studies.stage_clock import StageClock

_STRESSES = 2.5
"""Stresses of a tooth's roots over the face to all forces on the flanks, with the compliance that they need,
over that compliance: 2.2 to 2.9 of four gears on two meshes. In the plane as much as the compliance."""

UnitStresses = tuple[UnitRootStress, UnitRootStress]
Histories = tuple[RootStressHistory, RootStressHistory]

LOAD_SHARING = 0.02
"""Part of a root stress that the load of the tooth leaves open: a published series of solid models, less the
error of its mesh, is 0.7 to 2 % below (tests/validation/test_published_root_stress.py)."""


def stress_seconds(pair: ParallelAxes, plan: Plan, cache: Path | None) -> float:
    """Predict the CPU seconds of the unit-load stress of both gears on both meshes; nothing is meshed."""
    made, bodies = plan.discretization, plan.bodies(pair)
    hypothesis, times = PlaneHypothesis.PLANE_STRAIN, _STRESSES
    if isinstance(made, PlaneDiscretization):
        hypothesis, times = made.hypothesis, 1.0
    meshes = root_meshes(made)
    recipes: tuple[MeshRecipe | SectorRecipe, ...] = (*meshes.recipes, *meshes.coarse_recipes)
    gears = (body.right_handed() for body in (*bodies, *bodies))
    return times * sum(
        body_seconds(gear, recipe, cache)
        for gear, recipe in dict.fromkeys(zip(gears, recipes, strict=True))
        if not stress_cached(gear, recipe, hypothesis, cache)
    )


@brief
@dataclass(frozen=True)
class RootStress:
    """Tooth-root stress of both gears at one load and one alignment."""

    pinion: RootStressHistory
    wheel: RootStressHistory
    torque: float
    normal_force: float
    """`torque`, `normal_force`: On the driving gear, N m; F_bn, N."""
    misalignment: float
    center_distance_change: float
    """`misalignment`, `center_distance_change`: m."""
    receipt: Json
    """CPU seconds by stage, memory, the plan, assumptions and what was repeated: plain JSON."""
    warnings: list[Json] = field(default_factory=list)
    """What is implausible about the case or the stresses."""


def root_stress(
    pair: ParallelAxes | Checked,
    point: OperatingPoint | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    at: ArrayLike | None = None,
) -> RootStress:
    """Solve the contact of one load and alignment, and return the stress of the tooth roots.

    Parameters and errors are those of `flank_results`.
    """
    clock = StageClock(run.workers.cost)
    solved, receipt = solved_point(as_checked(pair, point, options), at, clock, run)
    with clock.stage("root stress"):
        pinion, wheel = _histories(solved, run.cache)
    run.progress("root stress", 1.0)
    request = solved.checked.request
    findings = [
        finding
        for name, history in (("pinion", pinion), ("wheel", wheel))
        for finding in root_findings(name, history.peak("tension").stress.value)
    ]
    warn_of(unexpected(request.findings, tuple(findings)))
    nominal = (finding for finding in request.findings if finding.check != "root_stress")
    return RootStress(
        pinion,
        wheel,
        torque=float(request.torque[0]),
        normal_force=float(request.load[0]),
        misalignment=float(request.misalignment[0]),
        center_distance_change=float(request.center_distance_change[0]),
        receipt=receipt | clock.to_json(),
        warnings=[finding.to_json() for finding in (*nominal, *findings)],
    )


def _histories(solved: SolvedOperatingPoint, cache: Path | None) -> list[RootStressHistory]:
    """Return the histories of both gears, with the error that rougher discretizations show."""
    units = unit_stresses(solved.contact, False, cache)
    fine = pair_histories(solved, units)
    rough = pair_histories(solved, unit_stresses(solved.contact, True, cache))
    remaining = root_meshes(solved.contact.plan.discretization).remaining
    changes = [remaining * _peak_changes(fine, rough), *_load_changes(solved, fine, units, cache)]
    errors = LOAD_SHARING + np.linalg.norm(changes, axis=0)
    return [
        replace(history, relative_error=error) for history, error in zip(fine, errors.tolist(), strict=True)
    ]


def _load_changes(
    solved: SolvedOperatingPoint, fine: Histories, units: UnitStresses, cache: Path | None
) -> Iterator[FloatArray]:
    """Yield the changes of the peaks of both gears (2,) by positions, slices and meshes of the contact."""
    for half in halves(fine[0].position):
        yield _peak_changes(fine, (fine[0].at(half), fine[1].at(half)))
    for both in rougher_solutions(solved, cache):
        finer, rougher = (pair_histories(solution, units) for solution in both)
        yield _peak_changes(finer, rougher)


def _peak_changes(fine: Histories, rough: Histories) -> FloatArray:
    """Return the changes of the peaks of both gears (2,), in parts of them.

    The greater of both roots: one difference of two solutions may vanish by chance.
    """
    peaks = np.array(
        [[[h.peak(root).stress.value for root in ROOTS] for h in both] for both in (fine, rough)]
    )
    return np.asarray(np.abs(peaks[1] / peaks[0] - 1.0).max(axis=1))


def unit_stresses(contact: PairContact, coarse: bool, cache: Path | None) -> UnitStresses:
    """Compute or fetch the unit-load stress of both gears; identical gears are computed once.

    `coarse`: on the meshes that tell the error of the others.
    """
    pair, meshes = contact.pair, root_meshes(contact.plan.discretization)
    gears = contact.plan.bodies(pair)
    if isinstance(meshes, FaceRootMeshes):
        sectors = meshes.coarse_recipes if coarse else meshes.recipes
        first, second = unit_root_stresses_3d(gears, sectors, cache=cache)
        # a ring's right flank is the loaded one as seen from the other side: its z runs against the pinion's
        return first, second.mirrored() if pair.internal else second
    sections = meshes.coarse_recipes if coarse else meshes.recipes
    first, second = unit_root_stresses(gears, sections, meshes.hypothesis, cache=cache)
    return first, second


def pair_histories(
    solved: SolvedOperatingPoint, units: UnitStresses
) -> tuple[RootStressHistory, RootStressHistory]:
    """Return the stress of both gears under the solved contact; `units` may be of any mesh."""
    pair, candidates = solved.contact.pair, solved.problem.candidates
    carrying = np.unique(candidates.pair)
    stressed = np.arange(carrying[0] - 1, carrying[-1] + 2)
    forces = _forces(solved, units, carrying)
    first, second = (
        RootStressHistory(
            position=candidates.position,
            pair=stressed,
            flank_coordinate=unit.station_s,
            tangent_angle=unit.tangent_angle,
            face_position=unit.station_z + offset,
            # pair j is on tooth -j of the driving gear and on tooth j of the driven one
            stress=_superposed(unit, loads, direction * (stressed[:, None] - carrying)),
            near_load=_near_load(solved, unit, patches, stressed, unit.station_z + offset),
            relative_error=np.nan,
            critical_coordinate=critical_section(tooth_profile(gear)),
        )
        for unit, loads, direction, gear, offset, patches in zip(
            units,
            forces,
            (-1, 1),
            (pair.pinion, pair.wheel),
            (0.0, pair.axial_offset),
            (candidates.slices.patch_1, candidates.slices.patch_2),
            strict=True,
        )
    )
    return first, second


def _forces(
    solved: SolvedOperatingPoint, units: UnitStresses, pairs: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the inward nodal forces on the teeth of `pairs` (K,) of both gears, (P, K, n)."""
    candidates, force = solved.problem.candidates, solved.solution.force[:, 0]
    out = [np.zeros((len(force), pairs.size, unit.stress.shape[-1])) for unit in units]
    for p in range(len(force)):
        if units[0].across_face:
            offset = solved.contact.pair.axial_offset
            both, inward = face_flank_forces(candidates, force, p, units, offset), -1.0
        else:
            both, inward = plane_flank_forces(candidates, force, p, units), 1.0
        for loads, by_tooth, direction in zip(out, both, (-1, 1), strict=True):
            for tooth, forces in by_tooth.items():
                loads[p, np.searchsorted(pairs, direction * tooth)] = inward * forces
    return out[0], out[1]


def _near_load(
    solved: SolvedOperatingPoint, unit: UnitRootStress, patches: Patches, stressed: IntArray, face: FloatArray
) -> BoolArray:
    """Return which stations, at `face` (q,), are within half a patch of a loaded patch, (P, N, p, q)."""
    candidates, force = solved.problem.candidates, solved.solution.force[:, 0]
    near = np.zeros((len(force), stressed.size, unit.station_s.size, face.size), dtype=bool)
    tooth = np.searchsorted(stressed, candidates.pair)
    for p, i in np.argwhere(force > 0.0):
        row = p % len(patches.center)
        half = patches.half_width[row, i]
        along = np.abs(unit.station_s - patches.center[row, i]) < 2.0 * half
        if along.any():
            across = np.abs(face - candidates.face_position[i]) < 0.5 * candidates.point_width + half
            near[p, tooth[i]] |= along[:, None] & (across | (not unit.across_face))
    return near


def _superposed(unit: UnitRootStress, forces: FloatArray, ahead: IntArray) -> FloatArray:
    """Add up what the loads of all pairs do to each tooth, (P, N, 2, 3, p, q).

    `ahead` (N, K) says how many teeth the stressed one is ahead of the loaded one; further than `unit` knows
    nothing arrives.
    """
    by_distance = unit.stress.reshape(len(unit.distance), -1, forces.shape[2])
    stress = np.zeros((len(forces), len(ahead), by_distance.shape[1]))
    for k in range(forces.shape[1]):
        loaded = np.flatnonzero(forces[:, k].any(axis=1))
        for j in range(len(ahead)):
            row = int(ahead[j, k] - unit.distance[0])
            if 0 <= row < len(by_distance):
                stress[loaded, j] += forces[loaded, k] @ by_distance[row].T
    return stress.reshape(*stress.shape[:2], *unit.stress.shape[1:-1])
