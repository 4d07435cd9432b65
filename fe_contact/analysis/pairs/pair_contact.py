"""Contact of a pair whose compliance is at hand: from positions and loads to a solution."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fe_contact.compliance import (
    FlankCompliance,
    FlankCompliance3D,
    finite_width_compliances,
    flank_compliances,
    flank_compliances_3d,
    free_ends_cached,
    section_cached,
    solid_cached,
)
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    ContactSolution,
    Slices,
    Start,
    contact_candidates,
    contact_problem,
    face_contact_problem,
    in_pitches,
    solve_contact,
    with_compliances,
    with_face_tilt,
    with_flanks,
)
from fe_contact.contact.plain_touch import Touch
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_model import condensed_teeth
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported

CACHED_PROBLEMS = 2
"""Position sets whose compliance is kept: the table's, while another is tried."""

PlaneFlanks = tuple[FlankCompliance, FlankCompliance]
FaceFlanks = tuple[FlankCompliance3D, FlankCompliance3D]
Bodies = PlaneFlanks | FaceFlanks
"""Compliances of both gears, in the plane or over the face."""


@dataclass(frozen=True)
class PairContact:
    """A pair whose flank compliances are known. Only gaps and contact are left to compute."""

    pair: ParallelAxes
    plan: Plan
    plane: PlaneFlanks | None = None
    face: FaceFlanks | None = None
    """`plane`, `face`: Compliances of both gears, in the plane or over the face width; exactly one of the
    two.
    """
    uncorrected: PlaneFlanks | None = None
    """Compliances in the plane before the correction for the finite width; None if there was no correction.
    """
    varied: bool = False
    """Whether the flanks of the pair are to vary. Problems then have the change of the compliance along the
    flanks, with or without slopes.
    """
    touches: dict[bytes, Touch] = field(default_factory=dict, repr=False)
    """Touching points of the flanks under the gaps of the one model that the pair is used with, by the bytes
    of the positions. Where the mapping lacks positions, each problem finds its own touching points.
    """
    _problems: dict[tuple[object, ...], ContactProblem] = field(default_factory=dict, repr=False)

    @classmethod
    def of_bodies(cls, pair: ParallelAxes, plan: Plan, bodies: Bodies) -> PairContact:
        """Return a pair with these compliances, which are in the plane or over the face as its plan is."""
        over_face = isinstance(plan.discretization, FaceDiscretization)
        return cls(pair, plan, **{"face" if over_face else "plane": bodies})  # type: ignore[arg-type]

    @property
    def bodies(self) -> Bodies:
        """Compliances of the gears; the same object at every center distance."""
        bodies = self.plane if self.face is None else self.face
        if bodies is None:
            raise ValueError("a pair contact needs the compliance of its gears")
        return bodies

    def solve(
        self,
        model: ContactModel,
        position: FloatArray,
        load: FloatArray,
        pitch: IntArray | None = None,
        start: Start | None = None,
    ) -> tuple[ContactProblem, ContactSolution]:
        """Solve positions (P,) in [0, 1) at normal forces (L,) in N, each in the first base pitch.

        With `pitch` (R,), R a multiple of P, there are R rows: position r modulo P in whole pitch `pitch[r]`.
        Rows of one position share its compliance. `start` has forces near the solution in every row.
        """
        problem = self.problem(model, position, pitch)
        return problem, solve_contact(problem, load, start)

    def problem(
        self, model: ContactModel, position: FloatArray, pitch: IntArray | None = None
    ) -> ContactProblem:
        """Assemble the contact problem that `solve` solves."""
        problem = self._problem(model, position)
        problem = with_flanks(self.pair, problem, model, self.touches.get(position.tobytes()))
        if pitch is None and not model.tooth_gaps:
            return problem
        first = np.zeros(position.size, dtype=np.int64)
        return in_pitches(self.pair, problem, model, first if pitch is None else pitch)

    def candidates(self, model: ContactModel, position: FloatArray) -> Candidates:
        """Return where plain involutes can touch at positions (P,) in [0, 1); nothing is assembled."""
        problem = self.cached_problem(model, position)
        return self._located_candidates(model, position) if problem is None else problem.candidates

    def cached_problem(self, model: ContactModel, position: FloatArray) -> ContactProblem | None:
        """Return the problem of plain involutes at positions (P,) if it is kept."""
        return self._problems.get(self.key(model, position))

    def take(self, model: ContactModel, problem: ContactProblem) -> None:
        """Keep a problem of plain involutes that was assembled remotely."""
        self._store(model, problem)

    def keep_rows(self, model: ContactModel, position: FloatArray, rows: IntArray) -> None:
        """Keep the compliance of some of the positions (P,) by itself: to `solve` them assembles nothing."""
        part = self._problem(model, position).rows(rows)
        self._problems[self.key(model, part.candidates.position)] = part

    def assemble(self, model: ContactModel, candidates: Candidates) -> None:
        """Keep the compliance at positions whose candidates are known, as they are of other bodies.

        To `solve` them then does not look for them again.
        """
        if self.key(model, candidates.position) not in self._problems:
            self._keep(model, candidates)

    @property
    def in_plane_strain(self) -> PairContact:
        """The same pair without the correction for its finite width; itself if it has none."""
        if self.uncorrected is None:
            return self
        return replace(self, plane=self.uncorrected, uncorrected=None, _problems={})

    def in_slices(self, count: int) -> PairContact:
        """Return the contact with another number of slices; itself in the plane."""
        made = self.plan.discretization
        if not isinstance(made, FaceDiscretization):
            return self
        plan = replace(self.plan, discretization=made.in_slices(count))
        return replace(self, plan=plan, touches={}, _problems={})  # a record of touch is one of its slices

    @property
    def in_coarse_patches(self) -> PairContact:
        """The same bodies under the load patches of the coarse meshes; itself where those are no wider."""
        if self.plan.coarse_patch == self.plan.patch:
            return self
        return replace(self, plan=replace(self.plan, patch=self.plan.coarse_patch), _problems={})

    def _problem(self, model: ContactModel, position: FloatArray) -> ContactProblem:
        """Return the problem of plain involutes, kept: gaps and loads do not change its compliance."""
        key = self.key(model, position)
        if key not in self._problems:
            self._keep(model, self._located_candidates(model, position))
        problem = self._problems[key]
        if self.face is not None and not problem.tilt.size and (self.varied or model.sloped):
            problem = with_face_tilt(problem, self.face, self.pair.axial_offset, model.couple_teeth)
            self._problems[key] = problem
        return problem

    def _located_candidates(self, model: ContactModel, position: FloatArray) -> Candidates:
        slices = Slices.of_pair(self.pair, self.plan.discretization.slices)
        return contact_candidates(self.pair, model, position, self.plan.patch, slices)

    def key(self, model: ContactModel, position: FloatArray) -> tuple[object, ...]:
        """Return the key of an assembled compliance for the same bodies."""
        return (position.tobytes(), model.corner_contact, model.couple_teeth, model.compliances)

    def _keep(self, model: ContactModel, candidates: Candidates) -> None:
        """Assemble the compliance of candidates; it replaces the oldest one in memory."""
        self._make_room()
        bodies = self._assembled(candidates, model.couple_teeth)
        self._store(model, with_compliances(self.pair, bodies, model))

    def _store(self, model: ContactModel, problem: ContactProblem) -> None:
        self._make_room()
        self._problems[self.key(model, problem.candidates.position)] = problem

    def _make_room(self) -> None:
        """Drop the oldest compliance, before the memory of another is needed."""
        while len(self._problems) >= CACHED_PROBLEMS:
            self._problems.pop(next(iter(self._problems)))

    def _assembled(self, candidates: Candidates, couple_teeth: bool) -> ContactProblem:
        if self.face is not None:
            return face_contact_problem(candidates, self.face, self.pair.axial_offset, couple_teeth)
        if self.plane is not None:
            return contact_problem(candidates, self.plane, couple_teeth)
        raise ValueError("a pair contact needs the compliance of its gears")


def pair_contact(
    pair: ParallelAxes,
    plan: Plan,
    cache: Path | None,
    coarse: bool = False,
    distance_changes: FloatArray | None = None,
    report: Report = unreported,
    *,
    coarse_next: bool = False,
) -> PairContact:
    """Compute or fetch the compliance of both gears; identical gears are computed once.

    Parameters
    ----------
    cache : Path, optional
        Directory of stored compliances; None computes afresh.
    coarse : bool
        Take the coarse meshes and their patches, which serve the error estimate; in the plane without the
        correction for the finite width, which has an error of its own.
    distance_changes : ndarray, optional
        Changes of the center distance in m at which the same compliance will be used.
    report : callable
        Called with the fraction done over the face, by predicted cost; in the plane it is not called.
    coarse_next : bool
        Whether the coarse compliance follows: in the plane one process meshes for both.
    """
    made, gears = plan.discretization, plan.bodies(pair)
    if coarse:
        plan = replace(plan, patch=plan.coarse_patch)
    if isinstance(made, FaceDiscretization):
        first, second = flank_compliances_3d(
            gears, made.coarse_recipes if coarse else made.recipes, cache=cache, report=report
        )
        # a ring's right flank is the loaded one as seen from the other side: its z runs against the pinion's
        return PairContact(pair, plan, face=(first, second.mirrored() if pair.internal else second))
    recipes = made.coarse_recipes if coarse else made.recipes
    teeth = _teeth(pair, distance_changes)  # those that can touch at once
    later = made.coarse_recipes if coarse_next else None
    pinion, wheel = flank_compliances(gears, recipes, made.hypothesis, teeth=teeth, cache=cache, later=later)
    flat = pinion, wheel
    if made.finite_width is None or coarse:
        return PairContact(pair, plan, plane=flat)
    ends = finite_width_compliances(gears, made.finite_width, flat[0].teeth.size, cache=cache)
    corrected = (ends[0].added_to(flat[0]), ends[1].added_to(flat[1]))
    return PairContact(pair, plan, plane=corrected, uncorrected=flat)


def bodies_are_cached(
    pair: ParallelAxes,
    plan: Plan,
    cache: Path | None,
    distance_changes: FloatArray | None = None,
    *,
    coarse: bool = False,
) -> bool:
    """Whether `pair_contact` of the same arguments would find both gears in the cache."""
    made, gears = plan.discretization, plan.bodies(pair)
    if isinstance(made, FaceDiscretization):
        solids = made.coarse_recipes if coarse else made.recipes
        return all(solid_cached(*recipe, cache) for recipe in zip(gears, solids, strict=True))
    teeth, recipes = _teeth(pair, distance_changes), made.coarse_recipes if coarse else made.recipes
    in_cache = [
        section_cached(*recipe, made.hypothesis, teeth, cache) for recipe in zip(gears, recipes, strict=True)
    ]
    if made.finite_width is not None and not coarse:
        in_cache += [
            free_ends_cached(*recipe, teeth, cache) for recipe in zip(gears, made.finite_width, strict=True)
        ]
    return all(in_cache)


def _teeth(pair: ParallelAxes, distance_changes: FloatArray | None) -> int:
    changes = () if distance_changes is None else distance_changes.tolist()
    others = [pair.at_center_distance(pair.center_distance + change) for change in changes if change]
    return max(condensed_teeth(variant) for variant in (pair, *others))
