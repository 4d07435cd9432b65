"""Plan, run, measure, refine what dominates: until the tolerance is met, or nothing brings it nearer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from bounds import engineering
from fe_contact.analysis.database.compute_database import compute_pass
from fe_contact.analysis.database.refinement import Refinement, next_pass
from fe_contact.analysis.database.tolerance_receipt import error_shares
from fe_contact.analysis.request.decided import Decided, model_name
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import FeContactError
from fe_contact.options import Run
from fe_contact.stage_clock import StageClock
from fe_contact.ste import SteDatabase
from fe_contact.types import Json

# The passes of a run under a tolerance, and what all of them cost.


@dataclass(frozen=True)
class Pass:
    """One run of the table on one discretization.

    Attributes
    ----------
    decided : Decided
        Model and discretization.
    cost : dict
        Times by stage and memory, as in a receipt.
    table : SteDatabase or None
        None: the pass failed.
    refinement : Refinement or None
        What was refined before it; None: the first one.
    failure : str
        Why there is no table.
    """

    decided: Decided
    cost: Json
    table: SteDatabase | None
    refinement: Refinement | None = None
    failure: str = ""

    @property
    def used(self) -> float:
        """Part of the tolerance that the measured errors use; infinite where that is not known."""
        used = None if self.table is None else self.table.metadata.receipt["tolerance"]["used"]
        return float("inf") if used is None else float(used)

    @property
    def name(self) -> str:
        """Model, mesh and slices in words."""
        return f"{model_name(self.decided.checked)}, {self.decided.mesh.option.name}"

    def to_json(self) -> Json:
        """Return what ran, what it cost, what it used, and what was refined before it and why."""
        mesh, made, table = self.decided.mesh, self.refinement, self.table
        failed = {"failure": self.failure} if self.failure else {}
        return failed | {
            "model": model_name(self.decided.checked),
            "level": mesh.level,
            "slices": mesh.slices,
            "positions": None if table is None else int(table.position.size),
            "cpu_seconds": self.cost["cpu_seconds"],
            "used": None if table is None else table.metadata.receipt["tolerance"]["used"],
            "refined": [] if made is None else list(made.steps),
            "because": mesh.reason,
            "expected_used": None if made is None else made.expected,
        }


def _of_all_passes(passes: Sequence[Pass], kept: SteDatabase, reason: str) -> SteDatabase:
    """Return the table of one pass with the receipt of all of them.

    Parameters
    ----------
    passes : sequence of Pass
        In the order in which they ran.
    kept : SteDatabase
        The table of one of them.
    reason : str
        Why no further pass was made.
    """
    receipt = kept.metadata.receipt | _summed([done.cost for done in passes])
    receipt["tolerance"] = receipt["tolerance"] | {"reason": reason}
    receipt["passes"] = [done.to_json() | {"kept": done.table is kept} for done in passes]
    return replace(kept, metadata=replace(kept.metadata, receipt=receipt))


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
    on_draft: OnDraft

    def first(self, checked: Checked) -> Pass:
        """Run what the accuracy is expected to ask for."""
        clock = StageClock(self.run.workers.cost)
        with clock.stage("planning"):
            decided = decide(checked, self.run.cache, tried=True)
        done = compute_pass(decided.checked, self.case, self.run, decided, clock)
        return Pass(done.decided, done.table.metadata.receipt, done.table)

    def refined(self, made: Refinement, clock: StageClock) -> Pass:
        """Run a refinement; one that fails or is interrupted says so."""
        decided = made.decided
        try:
            done = compute_pass(decided.checked, self.case, self.run, decided, clock)
        except KeyboardInterrupt:
            return Pass(decided, clock.to_json(), None, made, "interrupted")
        except (FeContactError, MemoryError) as error:
            return Pass(decided, clock.to_json(), None, made, str(error) or "out of memory")
        return Pass(done.decided, done.table.metadata.receipt, done.table, made)


def kept_tolerance(checked: Checked, case: Json, run: Run, on_draft: OnDraft) -> SteDatabase:
    """Compute the table of a request with a tolerance, in at most `MOST_PASSES` passes.

    Parameters
    ----------
    checked : Checked
        With a tolerance and a full receipt.
    case : dict
        Echoed into the result and hashed.
    run : Run
        Its cache is what passes share; None: one for this run. Progress begins anew with every pass.
    on_draft : callable
        Called with every table that is refined, and what is refined.

    Returns
    -------
    SteDatabase
        That of the pass that uses least of the tolerance, the last one if all goes well. `passes` of its
        receipt lists all of them, its cost is theirs, and `tolerance` says why there are no more.

    Raises
    ------
    MeshError, SolveError, WorkersLost
        Of the first pass; a later one that fails keeps the table before it.
    """
    if run.cache is not None:
        return _refined(checked, _Passes(case, run, on_draft))
    with TemporaryDirectory() as folder:
        return _refined(checked, _Passes(case, replace(run, cache=Path(folder)), on_draft))


def _refined(checked: Checked, shared: _Passes) -> SteDatabase:
    """Refine until there is a reason not to."""
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
        shared.on_draft(table, made.words)
        last = shared.refined(made, clock)
        passes.append(last)
        if last.table is None:
            return _of_all_passes(passes, table, f"pass {len(passes)} ({last.name}) failed: {last.failure}")
        if last.used >= best.used:
            reason = f"pass {len(passes)} ({made.words}) did not lower the measured errors"
            return _of_all_passes(passes, table, reason)
        best, table = last, last.table


def _following(table: SteDatabase, last: Pass) -> Refinement | str:
    """Return what to refine after a pass, or why nothing."""
    tolerance = last.decided.checked.request.options.allowed
    if table.metadata.receipt["tolerance"]["met"]:
        return "met"
    if table.n_failed:
        return f"{table.n_failed} points failed"
    return next_pass(last.decided, error_shares(table, tolerance))


def _ended(made: Refinement, passes: Sequence[Pass], cache: Path | None) -> str:
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
