"""The refinement of the next pass, decided by the errors that a pass has measured.

Each source of error has its refinement: the mesh the next level, slices more slices, positions a closer
search, the correction for a finite width three dimensions. The error after a step is predicted; the pass
itself then measures it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bounds import engineering
from fe_contact.analysis.request.model_choice import Decision, next_model
from fe_contact.options import LEVELS, MEDIUM
from fe_contact.planning.discretization import (
    FINER_SLICES,
    SLICE_ORDER,
    SLICES,
    FaceDiscretization,
    face_discretization,
)
from fe_contact.planning.plan import CLOSEST, NodeRule
from fe_contact.ste.curve_errors import AT_NODES, all_sources, source_words
from fe_contact.types import FloatArray

AIM = 0.9
"""Part of the tolerance that a pass is planned to use. The rest covers errors of the predictions."""

DOUBT = 2.0
"""Factor within which predictions are right: no pass begins where the finest mesh misses by more."""

SMALL = 0.3
"""Part of the tolerance below which a source is refined only where it decides: a tenth of the square sum."""

MESH_STEP = {
    "plane": {"draft": 0.45, "medium": 0.6, "standard": 0.2},
    "face": {"draft": 0.4, "medium": 0.55, "standard": 0.45},
}
"""Error of the next level over that of a level, from the pairs of docs/lab/index.md, "Constants"."""

CLOSER = 0.25
"""Error between positions that a step allows over the error allowed before the step."""

_MESH, _SLICES, _SOLVER, _WIDTH, _POSITION, _ = range(len(AT_NODES))


@dataclass(frozen=True)
class Refinement:
    """The next pass."""

    decision: Decision
    source: str
    """Largest source of error where most of the tolerance is used."""
    steps: tuple[str, ...]
    """Refinements in words."""
    expected: float
    """Part of the tolerance that the pass is predicted to use."""

    @property
    def text(self) -> str:
        """The refinement in one line."""
        return ", ".join(self.steps)


@dataclass(frozen=True)
class _Resolution:
    """Mesh, slices and search of positions, their predicted errors, and the steps that led there."""

    decision: Decision
    level: str
    slices: int
    nodes: NodeRule
    shares: FloatArray
    """Parts of the tolerance by source. Shape (6, ...)."""
    level_left: int
    """Number of mesh levels that steps may still go up."""
    steps: tuple[str, ...] = ()

    @property
    def used(self) -> float:
        """Largest part of the tolerance that is used."""
        return float(all_sources(self.shares).max())

    @property
    def sources(self) -> FloatArray:
        """Shares (6,) where most of the tolerance is used."""
        return self.shares.reshape(len(AT_NODES), -1)[:, int(np.argmax(all_sources(self.shares)))]

    def step(self, source: int) -> _Resolution | None:
        """Return the next finer resolution of a source; None if there is none."""
        plan = self.decision.plan
        across_face = isinstance(plan.discretization, FaceDiscretization)
        if source == _MESH:
            return self._next_level(across_face=across_face)
        if source == _SLICES and across_face:
            return self._more_slices()
        if source == _POSITION and plan.positions is None:
            usual = self.decision.usual_nodes.tolerance
            if self.nodes.tolerance * CLOSER < usual * CLOSEST:
                return None
            before, after = self.nodes.tolerance, CLOSER * self.nodes.tolerance
            nodes = replace(self.nodes, tolerance=after, maximum=2 * self.nodes.maximum)
            step = (
                f"positions {engineering(100 * before, 2)} -> {engineering(100 * after, 2)} % of the ripple"
            )
            return replace(self._with(_POSITION, CLOSER, step), nodes=nodes)
        return None

    def _next_level(self, *, across_face: bool) -> _Resolution | None:
        if self.level == LEVELS[-1] or not self.level_left:
            return None
        higher = "standard" if self.level == MEDIUM else LEVELS[LEVELS.index(self.level) + 1]
        part = MESH_STEP["face" if across_face else "plane"][self.level]
        finer = self._with(_MESH, part, f"mesh {self.level} -> {higher}")
        finer = replace(finer, level=higher, level_left=self.level_left - 1)
        fits = self._slices_that_fit(max(self.slices, SLICES), higher) if across_face else self.slices
        return finer._in_slices(fits)

    def _more_slices(self) -> _Resolution | None:
        """Take the next number of slices that the layers of the mesh resolve, or else a mesh with more."""
        for slices in (SLICES, *FINER_SLICES):
            count = self._slices_that_fit(slices, self.level)
            if count > self.slices:
                return self._in_slices(count)
        if self.slices >= FINER_SLICES[-1]:
            return None
        finer = self._next_level(across_face=True)
        if finer is None or finer.slices > self.slices:
            return finer
        return finer._more_slices()

    def _slices_that_fit(self, slices: int, level: str) -> int:
        return face_discretization(self.decision.checked.request.pair, level, slices).slices

    def _in_slices(self, count: int) -> _Resolution:
        if count == self.slices:
            return self
        part = (self.slices / count) ** SLICE_ORDER
        return replace(self._with(_SLICES, part, f"slices {self.slices} -> {count}"), slices=count)

    def _with(self, source: int, part: float, step: str) -> _Resolution:
        factors = np.ones(len(AT_NODES))
        factors[source] = part
        shares = self.shares * _by_source(factors, self.shares)
        return replace(self, shares=shares, steps=(*self.steps, step))


def next_pass(choice: Decision, shares: FloatArray) -> Refinement | str:
    """Choose which of the dominant sources to refine to meet the tolerance, or return why no pass pays.

    A pass goes up one mesh level at most, since the level between costs a third of the finer one. Where the
    scatter of runs is known, no pass begins that is expected to miss the tolerance and to lower the errors by
    less than the rest. `shares` (6 or more, ...) are the errors by source `AT_NODES` in parts of the allowed
    error, of every quantity at every node, without those that no run lowers; further sources are ignored.
    """
    plan = choice.plan
    initial = _Resolution(
        choice,
        plan.level,
        plan.discretization.slices,
        plan.nodes,
        shares=np.nan_to_num(shares[: len(AT_NODES)]),
        level_left=len(LEVELS),
    )
    source = int(np.argmax(initial.sources))
    finest = _refined_resolution(initial)
    barrier = _barrier(initial, finest)
    if barrier is not None:
        if barrier == _WIDTH and (model := next_model(choice.checked)):
            return _model_refinement(model, initial)
        return _refusal(finest, barrier)
    finer = _refined_resolution(replace(initial, level_left=1))
    share = engineering(initial.sources[source], 2)
    reason = f"{source_words(AT_NODES[source])} takes {share} of the tolerance"
    refined = choice.refined(finer.level, finer.slices, finer.nodes, reason)
    if refined.mesh.option.error.scatter and finer.used > 1.0 and initial.used - finer.used < finer.used:
        return (
            f"{', '.join(finer.steps)} would lower the errors from {engineering(initial.used, 2)} to "
            f"{engineering(finer.used, 2)} of the tolerance, by less than it leaves"
        )
    return Refinement(refined, AT_NODES[source], finer.steps, finer.used)


def finer_mesh(choice: Decision, failed: int) -> Refinement | str:
    """Return the pass on the next mesh, or why there is none, where `failed` points had no solution.

    On a coarse mesh strips may be wider than the load patches, where the compliance of the bodies is not
    positive for all forces and Newton's method may find no way.
    """
    plan, count = choice.plan, len(AT_NODES)
    initial = _Resolution(
        choice, plan.level, plan.discretization.slices, plan.nodes, shares=np.zeros((count, 1)), level_left=1
    )
    finer = initial.step(_MESH)
    if finer is None:
        return f"{failed} points failed"
    refined = choice.refined(finer.level, finer.slices, finer.nodes, f"{failed} points had no solution")
    expected = refined.mesh.option.error.reducible / choice.checked.request.options.allowed.relative
    return Refinement(refined, AT_NODES[_MESH], finer.steps, expected)


def _refined_resolution(resolution: _Resolution) -> _Resolution:
    """Refine the largest errors until the tolerance is predicted to be met, or nothing is left to refine."""
    while resolution.used > AIM:
        used, sources = resolution.used, resolution.sources
        decides = (used > 1.0) & (used**2 - sources**2 <= 1.0)  # without it the tolerance is met
        order = [int(k) for k in np.argsort(-sources, kind="stable") if sources[k] > SMALL or decides[k]]
        steps = (resolution.step(source) for source in order)
        finer = next((step for step in steps if step), None)
        if finer is None:
            break
        resolution = finer
    return resolution


def _barrier(initial: _Resolution, finest: _Resolution) -> int | None:
    """Return the source by which even the finest resolution misses the tolerance; None if it may be met.

    Measured errors count as they are; predicted ones may turn out smaller by the factor `DOUBT`.
    """
    predicted = np.array(
        [not np.array_equal(first, last) for first, last in zip(initial.shares, finest.shares, strict=True)]
    )
    doubt = _by_source(np.where(predicted, DOUBT, 1.0), finest.shares)
    best = replace(finest, shares=finest.shares / doubt)
    return int(np.argmax(best.sources)) if best.used > 1.0 else None


def _by_source(values: FloatArray, shares: FloatArray) -> FloatArray:
    """Return values (6,) by source in the shape (6, 1, ...), to multiply shares (6, ...)."""
    return values.reshape(-1, *[1] * (shares.ndim - 1))


def _model_refinement(model: Decision, initial: _Resolution) -> Refinement:
    """Return the pass of a more exact model: the error between positions as measured, the rest expected."""
    step = f"model {initial.decision.checked.model_name} -> {model.checked.model_name}"
    tolerance = model.checked.request.options.allowed.relative
    expected = float(np.hypot(model.mesh.option.error.reducible / tolerance, initial.shares[_POSITION].max()))
    return Refinement(model, AT_NODES[_WIDTH], (step,), expected)


def _refusal(finest: _Resolution, source: int) -> str:
    """Return why no refinement brings the error of a source within the tolerance."""
    plan = finest.decision.plan
    fixed = f"{plan.positions} positions were requested; leave positions out or request more"
    why = {
        _MESH: f"mesh {finest.level} is the finest",
        _SLICES: f"{finest.slices} slices are the limit",
        _SOLVER: "no refinement reduces the residuals of the contact",
        _WIDTH: "no other model for this request has a smaller expected error",
        _POSITION: fixed if plan.positions else "positions have the closest spacing of the search",
    }[source]
    share = finest.sources[source]
    return f"{AT_NODES[source]} would still take {engineering(share, 2)} of the tolerance: {why}"
