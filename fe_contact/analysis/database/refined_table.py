"""Passes of a run under a tolerance: plan, run, measure, refine the largest errors, until it is met."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from bounds import engineering
from fe_contact.analysis.database.compute_database import compute_pass
from fe_contact.analysis.database.refinement import Refinement, next_pass
from fe_contact.analysis.database.run_passes import Pass, of_all_passes
from fe_contact.analysis.estimates.tolerance_shares import bought_shares, error_shares
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import FeContactError
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from model_studies.stage_clock import StageClock

MAX_PASSES = 4

OnDraft = Callable[[SteDatabase, str], None]
"""Callback for the table of a pass that is refined, and the refined parts in words."""


@dataclass(frozen=True)
class _Passes:
    """The inputs that all passes share; the run has a cache."""

    case: Json
    run: Run
    on_draft: OnDraft | None

    def first(self, checked: Checked) -> Pass:
        """Run the discretization that the accuracy is expected to need."""
        clock = StageClock(self.run.workers.cost)
        with clock.stage("planning"):
            choice = decide(checked, self.run.cache, tried=True)
        done = compute_pass(choice.checked, self.case, self.run, choice, clock)
        return Pass(done.decision, done.table.metadata.receipt, done.table)

    def refined(self, made: Refinement, clock: StageClock) -> Pass:
        """Run a refinement; one that fails or is interrupted says so."""
        choice = made.decision
        try:
            done = compute_pass(choice.checked, self.case, self.run, choice, clock)
        except KeyboardInterrupt:
            return Pass(choice, clock.to_json(), None, made, "interrupted")
        except (FeContactError, MemoryError) as error:
            return Pass(choice, clock.to_json(), None, made, str(error) or "out of memory")
        return Pass(done.decision, done.table.metadata.receipt, done.table, made)


def refined_table(checked: Checked, case: Json, run: Run, on_draft: OnDraft | None) -> SteDatabase:
    """Compute the table of a request with a tolerance, in at most `MAX_PASSES` passes.

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
            return of_all_passes(passes, table, reason)
        if shared.on_draft is not None:
            shared.on_draft(table, made.text)
        last = shared.refined(made, clock)
        passes.append(last)
        if last.table is None:
            return of_all_passes(passes, table, f"pass {len(passes)} ({last.name}) failed: {last.failure}")
        if last.used >= best.used:
            reason = f"pass {len(passes)} ({made.text}) did not lower the measured errors"
            return of_all_passes(passes, table, reason)
        best, table = last, last.table


def _following(table: SteDatabase, last: Pass) -> Refinement | str:
    tolerance = last.decision.checked.request.options.allowed
    if table.metadata.receipt["tolerance"]["met"]:
        return "met"
    if table.n_failed:
        return f"{table.n_failed} points failed"
    at_nodes = table.metadata.receipt["tolerance"]["used_at_nodes"]
    if at_nodes is not None and at_nodes <= 1.0:
        return _beyond_between(table)
    bought, _ = bought_shares(error_shares(table, tolerance), last.decision.checked.request)
    measured = next_pass(last.decision, bought)
    behind = last.decision.behind
    if behind and last.refinement is None and (isinstance(measured, str) or measured.expected > 1.0):
        return _behind_trial(behind, last)
    return measured


def _behind_trial(behind: Decision, trial: Pass) -> Refinement:
    """Return the pass that was expected to follow a trial, where one step from the trial is not enough."""
    expected = behind.mesh.option.error.bought / behind.checked.request.options.allowed.relative
    name = f"{behind.checked.model_name}, {behind.mesh.option.name}"
    return Refinement(behind, "trial", (f"{trial.name} -> {name}",), expected)


def _beyond_between(table: SteDatabase) -> str:
    """Return the text of intervals that keep a table from its tolerance: no mesh lowers their errors."""
    intervals = table.metadata.receipt["tolerance"]["between_nodes"]
    if not intervals:
        return "the table cannot be interpolated between its nodes"
    return "; ".join(map(_interval_text, intervals))


def _interval_text(entry: Json) -> str:
    axis, (low, high) = entry["axis"].replace("_", " "), entry["between"]
    share = engineering(entry["used"], 2)
    return (
        f"between {axis} {low:.6g} and {high:.6g} interpolation takes {share} of the tolerance: "
        f"{entry['limit']}"
    )


def _ended(made: Refinement, passes: Sequence[Pass], cache: Path | None) -> str:
    """Say why a refinement does not begin, of passes or of time; empty if it may."""
    if len(passes) == MAX_PASSES:
        return f"the limit is {MAX_PASSES} passes"
    budget = made.decision.checked.request.options.time_budget
    if budget is None:
        return ""
    left = budget - sum(done.cost["cpu_seconds"] for done in passes)
    needed = made.decision.predicted(cache).cpu_seconds
    if needed <= left:
        return ""
    return (
        f"{made.text} is predicted to take {engineering(needed, 2)} "
        f"CPU s; {engineering(max(left, 0.0), 2)} of {budget:.3g} are left"
    )
