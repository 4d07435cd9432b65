"""Tooth-root stress of a gear pair: unit-load stress of both gears times the forces of the solved contact.

A unit-load stress is the stress at stations along a root for a unit force at each node of a flank. A history
is the stress at the stations over the positions of the mesh. Axes of arrays: P positions, N stressed teeth, K
pairs of teeth in contact, p stations along the root, q stations across the face, n flank nodes.
"""

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
"""CPU time of the unit-load stress of a gear in three dimensions over that of its compliance alone.

The stress needs the compliance, whose time is included. Measured 2.2 to 2.9 on four gears with two meshes
each. In the plane the ratio is 1.
"""

UnitStresses = tuple[UnitRootStress, UnitRootStress]
Histories = tuple[RootStressHistory, RootStressHistory]

LOAD_SHARING = 0.02
"""Relative error of a root stress that comes from how the load is put on the tooth.

It holds where flanks move little against their size. The stress published of a plastic wheel on a sector is
4.5 % lower than ours (docs/validation-table.md): its teeth tilt so far that the contact moves towards the
root, which unit loads on undeformed flanks do not follow.
"""


def stress_seconds(pair: ParallelAxes, plan: Plan, cache: Path | None) -> float:
    """Predict the CPU seconds of the unit-load stress of both gears on both meshes; nothing is meshed."""
    discretization = plan.discretization
    bodies = plan.bodies(pair)
    hypothesis = PlaneHypothesis.PLANE_STRAIN
    time_ratio = _STRESSES
    if isinstance(discretization, PlaneDiscretization):
        hypothesis = discretization.hypothesis
        time_ratio = 1.0
    meshes = root_meshes(discretization)
    recipes: tuple[MeshRecipe | SectorRecipe, ...] = (*meshes.recipes, *meshes.coarse_recipes)
    # both gears on the fine meshes, then both on the coarse ones
    gears = (body.right_handed() for body in (*bodies, *bodies))
    distinct = dict.fromkeys(zip(gears, recipes, strict=True))  # identical gears are computed once
    return time_ratio * sum(
        body_seconds(gear, recipe, cache)
        for gear, recipe in distinct
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
    """`torque`, `normal_force`: Torque on the driving gear, N m, and normal force of the teeth F_bn, N."""
    misalignment: float
    center_distance_change: float
    """`misalignment`, `center_distance_change`: Alignment of the gears, m."""
    receipt: Json
    """CPU seconds by stage, memory, the plan, assumptions and repeated solutions: plain JSON."""
    warnings: list[Json] = field(default_factory=list)
    """Findings about implausible values of the case or of the stresses."""


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
    # the request may have announced a root stress from a formula: the solved one takes its place
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


def _histories(point: SolvedOperatingPoint, cache: Path | None) -> list[RootStressHistory]:
    """Return the histories of both gears, with errors estimated from coarser discretizations."""
    units = unit_stresses(point.contact, coarse=False, cache=cache)
    fine = pair_histories(point, units)
    rough = pair_histories(point, unit_stresses(point.contact, coarse=True, cache=cache))
    # error of the fine mesh over the difference of both meshes
    mesh_error_ratio = root_meshes(point.contact.plan.discretization).remaining
    changes = [mesh_error_ratio * _peak_changes(fine, rough), *_load_changes(point, fine, units, cache)]
    errors = LOAD_SHARING + np.linalg.norm(changes, axis=0)
    return [
        replace(history, relative_error=error) for history, error in zip(fine, errors.tolist(), strict=True)
    ]


def _load_changes(
    point: SolvedOperatingPoint, fine: Histories, units: UnitStresses, cache: Path | None
) -> Iterator[FloatArray]:
    """Yield relative changes of the peaks of both gears (2,), one for each coarser contact solution.

    The coarser solutions have every second position, fewer slices, coarser load patches or a coarser mesh.
    """
    pinion, wheel = fine
    for half in halves(pinion.position):  # every second position, then the others
        yield _peak_changes(fine, (pinion.at(half), wheel.at(half)))
    for solutions in rougher_solutions(point, cache):
        yield _peak_changes(pair_histories(solutions.finer, units), pair_histories(solutions.rougher, units))


def _peak_changes(fine: Histories, rough: Histories) -> FloatArray:
    """Return the relative changes of the peak stresses of both gears (2,).

    Each is the greater one of both roots of a tooth: one of them alone may vanish by chance.
    """
    peaks = np.array(  # axes: fine or rough, gear, root
        [
            [[history.peak(root).stress.value for root in ROOTS] for history in histories]
            for histories in (fine, rough)
        ]
    )
    return np.asarray(np.abs(peaks[1] / peaks[0] - 1.0).max(axis=1))


def unit_stresses(contact: PairContact, coarse: bool, cache: Path | None) -> UnitStresses:
    """Compute or fetch the unit-load stress of both gears; identical gears are computed once.

    `coarse` selects the coarse meshes, which serve to estimate the error of the fine ones.
    """
    pair = contact.pair
    meshes = root_meshes(contact.plan.discretization)
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
    point: SolvedOperatingPoint, units: UnitStresses
) -> tuple[RootStressHistory, RootStressHistory]:
    """Return the stress of both gears under the solved contact; `units` may be of any mesh."""
    pair = point.contact.pair
    candidates = point.problem.candidates
    carrying = np.unique(candidates.pair)
    # the teeth before the first and after the last pair feel their load, too
    stressed = np.arange(carrying[0] - 1, carrying[-1] + 2)
    forces = _forces(point, units, carrying)
    first, second = (
        RootStressHistory(
            position=candidates.position,
            pair=stressed,
            flank_coordinate=unit.station_s,
            tangent_angle=unit.tangent_angle,
            face_position=unit.station_z + offset,
            # pair j is on tooth -j of the driving gear and on tooth j of the driven one
            stress=_superposed(unit, loads, direction * (stressed[:, None] - carrying)),
            near_load=_near_load(point, unit, patches, stressed, unit.station_z + offset),
            relative_error=np.nan,  # not estimated yet, see `_histories`
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
    point: SolvedOperatingPoint, units: UnitStresses, pairs: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the nodal forces on the teeth of `pairs` (K,) of both gears, > 0 into the flank, (P, K, n)."""
    candidates = point.problem.candidates
    force = point.solution.force[:, 0]  # at the only load
    out = [np.zeros((len(force), pairs.size, unit.stress.shape[-1])) for unit in units]
    for p in range(len(force)):
        if units[0].across_face:
            offset = point.contact.pair.axial_offset
            gears = face_flank_forces(candidates, force, p, units, offset)
        else:
            gears = plane_flank_forces(candidates, force, p, units)
        for loads, by_tooth, direction in zip(out, gears, (-1, 1), strict=True):
            for tooth, forces in by_tooth.items():
                pair_index = np.searchsorted(pairs, direction * tooth)
                loads[p, pair_index] = forces
    return out[0], out[1]


def _near_load(
    point: SolvedOperatingPoint, unit: UnitRootStress, patches: Patches, stressed: IntArray, face: FloatArray
) -> BoolArray:
    """Return whether stations lie in a loaded patch or within its half width of its ends, (P, N, p, q).

    `face` (q,) holds the positions of the stations across the face, m.
    """
    candidates = point.problem.candidates
    force = point.solution.force[:, 0]  # at the only load
    near = np.zeros((len(force), stressed.size, unit.station_s.size, face.size), dtype=bool)
    tooth = np.searchsorted(stressed, candidates.pair)
    for p, i in np.argwhere(force > 0.0):  # position and candidate
        row = p % len(patches.center)  # the arrays of patches repeat over the positions
        half = patches.half_width[row, i]
        along = np.abs(unit.station_s - patches.center[row, i]) < 2.0 * half
        if along.any():
            across = np.abs(face - candidates.face_position[i]) < 0.5 * candidates.point_width + half
            # a plane model has no stations across the face: distance along the root alone decides
            near[p, tooth[i]] |= along[:, None] & (across | (not unit.across_face))
    return near


def _superposed(unit: UnitRootStress, forces: FloatArray, ahead: IntArray) -> FloatArray:
    """Add up the stresses of each tooth under the loads of all pairs, (P, N, 2 roots, 3 components, p, q).

    `ahead` (N, K) says how many teeth the stressed one is ahead of the loaded one. Beyond the distances that
    `unit` has, a load causes no stress.
    """
    # unit stress by distance in teeth, stations and components flattened, flank nodes last
    by_distance = unit.stress.reshape(len(unit.distance), -1, forces.shape[2])
    stress = np.zeros((len(forces), len(ahead), by_distance.shape[1]))
    for k in range(forces.shape[1]):
        loaded = np.flatnonzero(forces[:, k].any(axis=1))
        for j in range(len(ahead)):
            row = int(ahead[j, k] - unit.distance[0])
            if 0 <= row < len(by_distance):
                stress[loaded, j] += forces[loaded, k] @ by_distance[row].T
    return stress.reshape(*stress.shape[:2], *unit.stress.shape[1:-1])
