"""Plan, run, measure, refine what dominates: until the tolerance is met, or nothing brings it nearer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bounds import engineering
from fe_contact.analysis.database.compute_database import compute_pass
from fe_contact.analysis.estimates.tolerance_shares import bought_shares, error_shares
from fe_contact.analysis.request.model_choice import Decided, decide, next_model
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import FeContactError
from fe_contact.options import LEVELS, Run
from fe_contact.planning.plan import (
    CLOSEST,
    FINER_SLICES,
    SLICE_ORDER,
    SLICES,
    FaceDiscretization,
    NodeRule,
    face_discretization,
)
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve import AT_NODES, all_sources
from fe_contact.types import FloatArray, Json
from model_studies.stage_clock import StageClock

# The refinement of the next pass, decided by the errors that a pass has measured.
#
# A source of error is refined by what it comes from: the mesh by the next level, slices by more of them,
# positions by a closer search, the correction for a finite width by three dimensions. How far a step takes
# its source down is predicted; what comes of it is measured by the pass itself.

AIM = 0.9
"""Part of the tolerance that a pass is planned to use; the rest is for what predictions miss."""
DOUBT = 2.0
"""Factor within which predictions are right: no pass begins where even the finest is too far off by it."""
SMALL = 0.3
"""Part of the tolerance, a tenth of what may be used, that is refined only where it decides."""
MESH_STEP = {"plane": {"draft": 0.45, "standard": 0.2}, "face": {"draft": 0.4, "standard": 0.45}}
"""Error of the next level over that of a level, from the pairs of docs/lab/accuracy.md, "Constants"."""
CLOSER = 0.25
"""Error between positions that a step allows over that before it."""
_MESH, _SLICES, _SOLVER, _WIDTH, _POSITION, _ = range(len(AT_NODES))


@dataclass(frozen=True)
class _Refinement:
    """The next pass.

    `source` takes most of the tolerance where most of it is used, `steps` say in words what is refined,
    and `expected` is the part of the tolerance that the pass is predicted to use.
    """

    decided: Decided
    source: str
    steps: tuple[str, ...]
    expected: float

    @property
    def words(self) -> str:
        """The refinement in one line."""
        return ", ".join(self.steps)


@dataclass(frozen=True)
class _Resolution:
    """Mesh, slices and search of positions, the errors predicted of them, and the steps that led there.

    `shares` (6, ...) are parts of the tolerance by source, `level_left` mesh levels may yet be gone up.
    """

    decided: Decided
    level: str
    slices: int
    nodes: NodeRule
    shares: FloatArray
    level_left: int
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
        plan = self.decided.plan
        across_face = isinstance(plan.discretization, FaceDiscretization)
        if source == _MESH:
            return self._next_level(across_face=across_face)
        if source == _SLICES and across_face:
            return self._more_slices()
        if source == _POSITION and plan.positions is None:
            usual = self.decided.usual_nodes.tolerance
            if self.nodes.tolerance * CLOSER < usual * CLOSEST:
                return None
            nodes = replace(self.nodes, tolerance=CLOSER * self.nodes.tolerance, most=2 * self.nodes.most)
            step = (
                f"positions {engineering(100 * self.nodes.tolerance, 2)} "
                f"-> {engineering(100 * nodes.tolerance, 2)} % of the ripple"
            )
            return replace(self._with(_POSITION, CLOSER, step), nodes=nodes)
        return None

    def _next_level(self, *, across_face: bool) -> _Resolution | None:
        if self.level == LEVELS[-1] or not self.level_left:
            return None
        higher = LEVELS[LEVELS.index(self.level) + 1]
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
        return finer and (finer if finer.slices > self.slices else finer._more_slices())

    def _slices_that_fit(self, slices: int, level: str) -> int:
        return face_discretization(self.decided.checked.request.pair, level, slices).slices

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


def _next_pass(decided: Decided, shares: FloatArray) -> _Refinement | str:
    """Choose what to refine, of the sources that dominate, to keep the tolerance; or say why no pass pays.

    A pass goes up one mesh level at most, since the level between costs a third of the finer one.
    `shares` (6 or more, ...) are the errors by source `AT_NODES` in parts of what is allowed, of every
    quantity at every node, without those that no run lowers; more sources are not looked at.
    """
    plan = decided.plan
    begun = _Resolution(
        decided,
        plan.level,
        plan.discretization.slices,
        plan.nodes,
        np.nan_to_num(shares[: len(AT_NODES)]),
        len(LEVELS),
    )
    source = int(np.argmax(begun.sources))
    finest = _settled(begun)
    barrier = _barrier(begun, finest)
    if barrier is not None:
        if barrier == _WIDTH and (model := next_model(decided.checked)):
            return _of_model(model, begun)
        return _no_way(finest, barrier)
    finer = _settled(replace(begun, level_left=1))
    reason = f"{AT_NODES[source]} takes {engineering(begun.sources[source], 2)} of the tolerance"
    refined = decided.refined(finer.level, finer.slices, finer.nodes, reason)
    return _Refinement(refined, AT_NODES[source], finer.steps, finer.used)


def _settled(resolution: _Resolution) -> _Resolution:
    """Refine what dominates until the tolerance is predicted to be kept, or nothing is left to refine."""
    while resolution.used > AIM:
        used, sources = resolution.used, resolution.sources
        decides = (used > 1.0) & (used**2 - sources**2 <= 1.0)
        order = [k for k in np.argsort(-sources, kind="stable") if sources[k] > SMALL or decides[k]]
        finer = next((step for source in order if (step := resolution.step(int(source)))), None)
        if finer is None:
            break
        resolution = finer
    return resolution


def _barrier(begun: _Resolution, finest: _Resolution) -> int | None:
    """Return the source that keeps even the finest resolution from the tolerance; None if it may be kept.

    What is measured stands as it is; what is predicted may turn out less by a factor `DOUBT`.
    """
    changed = np.array([not np.array_equal(*both) for both in zip(begun.shares, finest.shares, strict=True)])
    hoped = replace(finest, shares=finest.shares / _by_source(np.where(changed, DOUBT, 1.0), finest.shares))
    return int(np.argmax(hoped.sources)) if hoped.used > 1.0 else None


def _by_source(values: FloatArray, shares: FloatArray) -> FloatArray:
    return values.reshape(-1, *[1] * (shares.ndim - 1))


def _of_model(model: Decided, begun: _Resolution) -> _Refinement:
    """Return the pass of a more exact model; what lies between positions stays, the rest is expected."""
    step = f"model {begun.decided.checked.model_name} -> {model.checked.model_name}"
    tolerance = model.checked.request.options.allowed.relative
    expected = float(np.hypot(model.mesh.option.error.bought / tolerance, begun.shares[_POSITION].max()))
    return _Refinement(model, AT_NODES[_WIDTH], (step,), expected)


def _no_way(finest: _Resolution, source: int) -> str:
    plan = finest.decided.plan
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


# The passes of a run under a tolerance, and what all of them cost.


@dataclass(frozen=True)
class _Pass:
    """One run of the table on one discretization."""

    decided: Decided
    """Model and discretization."""
    cost: Json
    """Times by stage and memory, as in a receipt."""
    table: SteDatabase | None
    """None: the pass failed."""
    refinement: _Refinement | None = None
    """What was refined before it; None: the first one."""
    failure: str = ""
    """Why there is no table."""

    @property
    def used(self) -> float:
        """Part of the tolerance that the measured errors use; infinite where that is not known."""
        used = None if self.table is None else self.table.metadata.receipt["tolerance"]["used"]
        return float("inf") if used is None else float(used)

    @property
    def name(self) -> str:
        """Model, mesh and slices in words."""
        return f"{self.decided.checked.model_name}, {self.decided.mesh.option.name}"

    def to_json(self) -> Json:
        """Return what ran, what it cost, what it used, and what was refined before it and why."""
        mesh, made, table = self.decided.mesh, self.refinement, self.table
        failed = {"failure": self.failure} if self.failure else {}
        return failed | {
            "model": self.decided.checked.model_name,
            "level": mesh.level,
            "slices": mesh.slices,
            "positions": None if table is None else int(table.position.size),
            "cpu_seconds": self.cost["cpu_seconds"],
            "used": None if table is None else table.metadata.receipt["tolerance"]["used"],
            "refined": [] if made is None else list(made.steps),
            "because": mesh.reason,
            "expected_used": None if made is None else made.expected,
        }


def _of_all_passes(passes: Sequence[_Pass], kept: SteDatabase, reason: str) -> SteDatabase:
    """Return the table of one pass with the receipt of all, and the reason why there was no further one."""
    receipt = kept.metadata.receipt | _summed([done.cost for done in passes])
    receipt["tolerance"] = receipt["tolerance"] | {"reason": reason}
    receipt["prediction"] = receipt["prediction"] | _predicted(passes)
    receipt["passes"] = [done.to_json() | {"kept": done.table is kept} for done in passes]
    return replace(kept, metadata=replace(kept.metadata, receipt=receipt))


def _predicted(passes: Sequence[_Pass]) -> Json:
    """Add up what was predicted of every pass before it began; memory is the largest."""
    predictions = [done.table.metadata.receipt["prediction"] for done in passes if done.table is not None]
    stages = {
        name: sum(prediction["stages"][name] for prediction in predictions)
        for name in predictions[0]["stages"]
    }
    memory = max(prediction["memory_bytes"] for prediction in predictions)
    return {"stages": stages, "cpu_seconds": sum(stages.values()), "memory_bytes": memory}


def _summed(costs: Sequence[Json]) -> Json:
    """Add up times by stage; memory is the largest."""
    kinds = ("cpu_seconds", "wall_seconds")
    names = dict.fromkeys(name for cost in costs for name in cost["stages"])
    times = {name: [cost["stages"][name] for cost in costs if name in cost["stages"]] for name in names}
    stages = {
        name: {kind: sum(time[kind] for time in each) for kind in kinds} for name, each in times.items()
    }
    total: Json = {kind: sum(cost[kind] for cost in costs) for kind in kinds}
    total |= {"stages": stages, "peak_memory_bytes": max(cost["peak_memory_bytes"] for cost in costs)}
    others = [cost["elsewhere"] for cost in costs if "elsewhere" in cost]
    if others:  # the peak and the loss of workers are those of all passes so far
        sums = {name: sum(remote[name] for remote in others) for name in ("tasks", "cpu_seconds")}
        total["elsewhere"] = others[-1] | sums
    return total


MOST_PASSES = 4

OnDraft = Callable[[SteDatabase, str], None]
"""Called with the table of a pass that is refined, and what is refined in words."""


@dataclass(frozen=True)
class _Passes:
    """The inputs that all passes share; the run has a cache."""

    case: Json
    run: Run
    on_draft: OnDraft | None

    def first(self, checked: Checked) -> _Pass:
        """Run what the accuracy is expected to ask for."""
        clock = StageClock(self.run.workers.cost)
        with clock.stage("planning"):
            decided = decide(checked, self.run.cache, tried=True)
        done = compute_pass(decided.checked, self.case, self.run, decided, clock)
        return _Pass(done.decided, done.table.metadata.receipt, done.table)

    def refined(self, made: _Refinement, clock: StageClock) -> _Pass:
        """Run a refinement; one that fails or is interrupted says so."""
        decided = made.decided
        try:
            done = compute_pass(decided.checked, self.case, self.run, decided, clock)
        except KeyboardInterrupt:
            return _Pass(decided, clock.to_json(), None, made, "interrupted")
        except (FeContactError, MemoryError) as error:
            return _Pass(decided, clock.to_json(), None, made, str(error) or "out of memory")
        return _Pass(done.decided, done.table.metadata.receipt, done.table, made)


def kept_tolerance(checked: Checked, case: Json, run: Run, on_draft: OnDraft | None) -> SteDatabase:
    """Compute the table of a request with a tolerance, in at most `MOST_PASSES` passes.

    Raises `MeshError`, `SolveError`, `WorkersLost` of the first pass; a later one that fails keeps the table
    before it.

    Parameters
    ----------
    checked : Checked
        With a tolerance and a full receipt.
    case : dict
        Echoed into the result and hashed.
    run : Run
        Its cache is what passes share; None: one for this run. Progress begins anew with every pass.
    on_draft : callable, optional
        Called with every table that is refined, and what is refined.

    Returns
    -------
    SteDatabase
        That of the pass that uses least of the tolerance, the last one if all goes well. `passes` of its
        receipt lists all of them, its cost is theirs, and `tolerance` says why there are no more.
    """
    if run.cache is not None:
        return _refined(checked, _Passes(case, run, on_draft))
    with TemporaryDirectory() as folder:
        return _refined(checked, _Passes(case, replace(run, cache=Path(folder)), on_draft))


def _refined(checked: Checked, shared: _Passes) -> SteDatabase:
    best = shared.first(checked)
    passes = [best]
    assert best.table is not None
    table = best.table
    while True:
        clock = StageClock(shared.run.workers.cost)
        with clock.stage("planning"):
            made = _following(table, best)
            reason = made if isinstance(made, str) else _ended(made, passes, shared.run.cache)
        if isinstance(made, str) or reason:
            return _of_all_passes(passes, table, reason)
        if shared.on_draft is not None:
            shared.on_draft(table, made.words)
        last = shared.refined(made, clock)
        passes.append(last)
        if last.table is None:
            return _of_all_passes(passes, table, f"pass {len(passes)} ({last.name}) failed: {last.failure}")
        if last.used >= best.used:
            reason = f"pass {len(passes)} ({made.words}) did not lower the measured errors"
            return _of_all_passes(passes, table, reason)
        best, table = last, last.table


def _following(table: SteDatabase, last: _Pass) -> _Refinement | str:
    tolerance = last.decided.checked.request.options.allowed
    if table.metadata.receipt["tolerance"]["met"]:
        return "met"
    if table.n_failed:
        return f"{table.n_failed} points failed"
    at_nodes = table.metadata.receipt["tolerance"]["used_at_nodes"]
    if at_nodes is not None and at_nodes <= 1.0:
        return _beyond_between(table)
    bought, _ = bought_shares(error_shares(table, tolerance), last.decided.checked.request)
    measured = _next_pass(last.decided, bought)
    behind = last.decided.behind
    if behind and last.refinement is None and (isinstance(measured, str) or measured.expected > 1.0):
        return _behind_trial(behind, last)
    return measured


def _behind_trial(behind: Decided, trial: _Pass) -> _Refinement:
    """Return the pass that was expected to follow a trial, where one step from the trial is not enough."""
    expected = behind.mesh.option.error.bought / behind.checked.request.options.allowed.relative
    name = f"{behind.checked.model_name}, {behind.mesh.option.name}"
    return _Refinement(behind, "trial", (f"{trial.name} -> {name}",), expected)


def _beyond_between(table: SteDatabase) -> str:
    """Say which intervals alone keep a table from its tolerance: no mesh lowers what they take."""
    missed = table.metadata.receipt["tolerance"]["between_nodes"]
    if not missed:
        return "the table cannot be interpolated between its nodes"
    return "; ".join(map(_interval_words, missed))


def _interval_words(entry: Json) -> str:
    axis, (low, high) = entry["axis"].replace("_", " "), entry["between"]
    share = engineering(entry["used"], 2)
    return (
        f"between {axis} {low:.6g} and {high:.6g} interpolation takes {share} of the tolerance: "
        f"{entry['limit']}"
    )


def _ended(made: _Refinement, passes: Sequence[_Pass], cache: Path | None) -> str:
    """Say why a refinement does not begin, of passes or of time; empty if it may."""
    if len(passes) == MOST_PASSES:
        return f"the limit is {MOST_PASSES} passes"
    budget = made.decided.checked.request.options.time_budget
    if budget is None:
        return ""
    left = budget - sum(done.cost["cpu_seconds"] for done in passes)
    needed = made.decided.predicted(cache).cpu_seconds
    if needed <= left:
        return ""
    return (
        f"{made.words} is predicted to take {engineering(needed, 2)} "
        f"CPU s; {engineering(max(left, 0.0), 2)} of {budget:.3g} are left"
    )
