"""Tooth-root stress of a gear pair: unit-load stress of both gears times the forces of the solved contact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bounds import warn_of
from fe_contact.analysis.flanks.rougher_solutions import halves, rougher_solutions
from fe_contact.analysis.flanks.solved_operating_point import solved_point
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.compliance import (
    PlaneHypothesis,
    UnitRootStress,
    stress_kept,
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
from fe_contact.planning.plan import FaceDiscretization, Plan, PlaneDiscretization
from fe_contact.plausibility import root_findings, unexpected
from fe_contact.types import BoolArray, Estimate, FloatArray, IntArray, Json
from model_studies import in_unit
from model_studies.stage_clock import StageClock

# Stress of the tooth roots of one gear over the mesh cycle: history, peaks, where they are.

Root = Literal["tension", "compression"]
ROOTS: tuple[Root, Root] = ("tension", "compression")


@dataclass(frozen=True)
class RootPeak:
    """The largest stress of a cycle, and where it is."""

    stress: Estimate
    """Largest principal stress of the tension root, smallest one of the compression root (< 0), Pa, with the
    error of the root's mesh, of the contact's discretization and of the model.
    """
    position: float
    """Base pitches."""
    pair: int
    """Whose tooth; position (modulo 1) + pair counts along the passage of one tooth."""
    flank_coordinate: float = field(metadata=in_unit("m"))
    """m; between stations by a parabola."""
    tangent_angle: float = field(metadata=in_unit("rad"))
    """Of the surface there with the tooth's center line, rad."""
    face_position: float = field(metadata=in_unit("m"))
    """Distance from the pinion's mid-face, m."""


@dataclass(frozen=True)
class RootPassage:
    """The stress in the roots of one tooth on its way through the mesh."""

    position: FloatArray = field(metadata=in_unit("1", "passage"))
    """Position of the tooth's own pair in base pitches, increasing: 0 = its pitch point. Shape (M,)."""
    tension: FloatArray = field(metadata=in_unit("pa", "passage"))
    compression: FloatArray = field(metadata=in_unit("pa", "passage"))
    """`tension`, `compression`: Largest principal stress anywhere in the tension root; smallest one in the
    compression root, Pa. Shape (M,) each.
    """
    at_tension_peak: FloatArray = field(metadata=in_unit("pa", "passage"))
    at_compression_peak: FloatArray = field(metadata=in_unit("pa", "passage"))
    """`at_tension_peak`, `at_compression_peak`: Stress along the profile at the station nearest to the peak:
    what fatigue counts, Pa. Shape (M,) each.
    """


@dataclass(frozen=True)
class RootStressHistory:
    """Surface stress of the tooth roots of one gear."""

    position: FloatArray
    """Base pitches, by the driving gear's angle. Shape (P,)."""
    pair: IntArray
    """Pair index of each tooth: those that touch, and one beyond at either end, which only neighbors load.
    Shape (N,).
    """
    flank_coordinate: FloatArray
    """Of the stations along the profile, m, from the middle of the tooth space to the form point. Shape (p,).
    """
    tangent_angle: FloatArray
    """Of the surface there with the tooth's center line, rad. Shape (p,)."""
    face_position: FloatArray
    """Of the stations across, as distance from the pinion's mid-face, m; a single one in the plane. Shape
    (q,).
    """
    stress: FloatArray
    """Pa. Third axis: tension root (beside the loaded flank), compression root. Fourth: along the profile,
    across it in the surface, shear between the two. Shape (P, N, 2, 3, p, q).
    """
    near_load: BoolArray
    """Stations of the tension root under a load patch of their tooth or within half a patch of it. The
    surface there is not free, and the patch is wider than the contact: they count for no peak. Shape (P, N,
    p, q).
    """
    relative_error: float
    """Of the peaks: by the mesh of the root, by positions, slices and mesh of the contact, and by the model.
    """
    critical_coordinate: float
    """Where ISO 6336-3 takes the critical section: the tangent has 30 degrees (internal gears: 60) with the
    tooth's center line, m.
    """

    def at(self, positions: BoolArray) -> RootStressHistory:
        """Return the same at some of the positions (P,)."""
        rows = {name: getattr(self, name)[positions] for name in ("position", "stress", "near_load")}
        return replace(self, **rows)

    def principal(self, root: Root) -> FloatArray:
        """Largest principal stress of the tension root or smallest of the compression root, (P, N, p, q)."""
        along, across, shear = np.moveaxis(self.stress[:, :, ROOTS.index(root)], 2, 0)
        mean, radius = 0.5 * (along + across), np.hypot(0.5 * (along - across), shear)
        return np.asarray(mean + radius if root == "tension" else mean - radius)

    def peak(self, root: Root) -> RootPeak:
        """Return the peak of one root over all positions, teeth and stations."""
        sign = 1.0 if root == "tension" else -1.0
        values, at = self._crests(root)
        i, j, q = np.unravel_index(int(np.argmax(values)), values.shape)
        value, s = sign * float(values[i, j, q]), float(at[i, j, q])
        error = abs(value) * self.relative_error
        return RootPeak(
            stress=Estimate(value, error, "Pa"),
            position=float(self.position[i]),
            pair=int(self.pair[j]),
            flank_coordinate=s,
            tangent_angle=float(np.interp(s, self.flank_coordinate, self.tangent_angle)),
            face_position=float(self.face_position[q]),
        )

    def _crests(self, root: Root) -> tuple[FloatArray, FloatArray]:
        """Return the extreme along the profile, > 0 as it should be, and its place, (P, N, q)."""
        if root == "compression":
            values = -self.principal(root)
        else:
            values = np.where(self.near_load, -np.inf, self.principal(root))
        return _crest_values(self.flank_coordinate, np.moveaxis(values, 2, -1))

    def passage(self) -> RootPassage:
        """Return what one tooth meets, all its pairs' positions in a row.

        Positions in several base pitches are of several teeth, which then stand beside each other.
        """
        # In a later base pitch pair j stands where pair j stood before: other teeth, the same way.
        position = (self.position[:, None] % 1.0 + self.pair).ravel()
        order = np.argsort(position, kind="stable")
        extremes, fixed = [], []
        for root, sign in zip(ROOTS, (1.0, -1.0), strict=True):
            values, _ = self._crests(root)
            extremes.append(sign * values.max(axis=-1).ravel()[order])
            peak = self.peak(root)
            station = np.argmin(np.abs(self.flank_coordinate - peak.flank_coordinate))
            across = np.argmin(np.abs(self.face_position - peak.face_position))
            along = self.stress[:, :, ROOTS.index(root), 0, station, across]
            fixed.append(along.ravel()[order])
        return RootPassage(position[order], extremes[0], extremes[1], fixed[0], fixed[1])


def _crest_values(s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest value (...) along the last axis and its place, by a parabola through its neighbors.

    `s` (p >= 3,) increases; in `values` (..., p) minus infinity does not count, and beside it there is no
    parabola.
    """
    middle = np.clip(np.argmax(values, axis=-1), 1, s.size - 2)
    low, here, high = (s[middle + step] for step in (-1, 0, 1))
    y = [np.take_along_axis(values, (middle + step)[..., None], axis=-1)[..., 0] for step in (-1, 0, 1)]
    whole = np.all(np.isfinite(y), axis=0)
    first, second = (
        np.subtract(b, a, out=np.zeros_like(a), where=whole) / way
        for a, b, way in ((y[0], y[1], here - low), (y[1], y[2], high - here))
    )
    bend = (second - first) / (high - low)
    slope = first + bend * (here - low)  # at the middle
    flat = bend >= 0.0  # no crest inside: a rising end, all alike, or no three values
    way = np.clip(-slope / np.where(flat, -1.0, 2.0 * bend), low - here, high - here)
    value = np.where(flat, np.max(y, axis=0), y[1] + way * (slope + bend * way))
    position = np.where(flat, np.choose(np.argmax(y, axis=0), [low, here, high]), here + way)
    return value, position


# Meshes for the stress of the tooth roots, and coarser ones that tell its error.

FINER_LAND, FINER_DEPTH = 2, 2.0 / 3.0
"""Elements along the root, and their depth below both flanks, against those of the contact's sectors."""


@dataclass(frozen=True)
class _PlaneRootMeshes:
    """Sections of both gears, driving gear first: those of the contact, and others half as fine."""

    hypothesis: PlaneHypothesis
    recipes: tuple[MeshRecipe, MeshRecipe]
    coarse_recipes: tuple[MeshRecipe, MeshRecipe]

    remaining = 1.0 / 3.0
    """Error left over the difference of the two meshes: ratio two, second order."""


@dataclass(frozen=True)
class _FaceRootMeshes:
    """Sectors of both gears, driving gear first: those of the contact, finer at the root.

    The coarse ones are the contact's own, with layers of the next coarser mesh.
    """

    recipes: tuple[SectorRecipe, SectorRecipe]
    coarse_recipes: tuple[SectorRecipe, SectorRecipe]

    remaining = 0.8
    """Error left over the difference of the two meshes: ratio one and a half or more, second order."""


def root_meshes(made: PlaneDiscretization | FaceDiscretization) -> _PlaneRootMeshes | _FaceRootMeshes:
    """Choose the meshes of the root stress for a contact discretized as `made`."""
    if isinstance(made, PlaneDiscretization):
        return _PlaneRootMeshes(made.hypothesis, made.recipes, made.coarse_recipes)
    first, second = (_finer_root(recipe) for recipe in made.recipes)
    coarse = tuple(
        replace(recipe, layers=coarser.layers)
        for recipe, coarser in zip(made.recipes, made.coarse_recipes, strict=True)
    )
    return _FaceRootMeshes((first, second), (coarse[0], coarse[1]))


def _finer_root(recipe: SectorRecipe) -> SectorRecipe:
    """Return the recipe with a root fine enough for its stress; the flank stays as it is."""
    return replace(
        recipe,
        land_elements=FINER_LAND * recipe.land_elements,
        depth_size=FINER_DEPTH * recipe.depth_size,
    )


_STRESSES = 2.5
"""Stresses of a tooth's roots over the face to all forces on the flanks, with the compliance that they need,
over that compliance: 2.2 to 2.9 of four gears on two meshes. In the plane as much as the compliance."""


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
        if not stress_kept(gear, recipe, hypothesis, cache)
    )


UnitStresses = tuple[UnitRootStress, UnitRootStress]
Histories = tuple[RootStressHistory, RootStressHistory]


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


LOAD_SHARING = 0.02
"""Part of a root stress that the load of the tooth leaves open: a published series of solid models, less the
error of its mesh, is 0.7 to 2 % below (tests/validation/test_published_root_stress.py)."""


def _histories(solved: SolvedOperatingPoint, cache: Path | None) -> list[RootStressHistory]:
    """Return the histories of both gears, with the error that rougher discretizations show."""
    units = unit_stresses(solved.contact, False, cache)
    fine = _pair_histories(solved, units)
    rough = _pair_histories(solved, unit_stresses(solved.contact, True, cache))
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
        finer, rougher = (_pair_histories(each, units) for each in both)
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
    if isinstance(meshes, _FaceRootMeshes):
        sectors = meshes.coarse_recipes if coarse else meshes.recipes
        first, second = unit_root_stresses_3d(gears, sectors, cache=cache)
        # a ring's right flank is the loaded one as seen from the other side: its z runs against the pinion's
        return first, second.mirrored() if pair.internal else second
    sections = meshes.coarse_recipes if coarse else meshes.recipes
    first, second = unit_root_stresses(gears, sections, meshes.hypothesis, cache=cache)
    return first, second


def _pair_histories(
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
