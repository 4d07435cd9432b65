"""Passes of a run under a tolerance: plan, run, measure, refine the largest errors, until it is met.

A *pass* computes the table on one discretization, with its errors. A *trial* is a cheap first pass that is
expected to miss the tolerance; `Decision.behind` is the pass that is expected to follow it. Errors at the
*nodes* of a table are those of the model and its meshes; between nodes interpolation has errors too. `used`
is an error over the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from bounds import engineering
from fe_contact.analysis.database.compute_database import compute_pass
from fe_contact.analysis.database.refinement import Refinement, finer_mesh, next_pass
from fe_contact.analysis.database.run_passes import Pass, table_of_passes
from fe_contact.analysis.estimates.tolerance_shares import error_shares, reducible_shares
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import FeContactError
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from model_studies.stage_clock import StageClock

MAX_PASSES = 4
"""Most passes of one request."""

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

    def refined(self, refinement: Refinement, clock: StageClock) -> Pass:
        """Run a refinement; the pass has no table but a `failure` if it failed or was interrupted."""
        choice = refinement.decision
        try:
            done = compute_pass(choice.checked, self.case, self.run, choice, clock)
        except KeyboardInterrupt:
            return Pass(choice, clock.to_json(), None, refinement, "interrupted")
        except (FeContactError, MemoryError) as error:
            return Pass(choice, clock.to_json(), None, refinement, str(error) or "out of memory")
        return Pass(done.decision, done.table.metadata.receipt, done.table, refinement)


def refined_table(checked: Checked, case: Json, run: Run, on_draft: OnDraft | None) -> SteDatabase:
    """Compute the table of a request with a tolerance, in at most `MAX_PASSES` passes.

    Raises `MeshError`, `SolveError`, `WorkersLost` if the first pass fails. If a later pass fails, the table
    of the pass before it is the result.

    Parameters
    ----------
    checked : Checked
        Request with a tolerance and a full receipt.
    case : dict
        Case that is echoed into the result and hashed.
    run : Run
        Passes share compliances by the cache of the run; without one they share a temporary directory.
        Progress begins anew with every pass.
    on_draft : callable, optional
        Called with every table that is refined, and the refined parts in words.

    Returns
    -------
    SteDatabase
        Table of the pass that uses the smallest part of the tolerance: the last pass, unless that failed or
        did not lower the errors. In its receipt `passes` lists all passes, the cost is that of all of them,
        and `tolerance` says why there was no further pass.
    """
    if run.cache is not None:
        return _refined_database(checked, _Passes(case, run, on_draft))
    with TemporaryDirectory() as folder:
        return _refined_database(checked, _Passes(case, replace(run, cache=Path(folder)), on_draft))


def _refined_database(checked: Checked, shared: _Passes) -> SteDatabase:
    best = shared.first(checked)
    passes = [best]
    assert best.table is not None
    table = best.table
    while True:
        clock = StageClock(shared.run.workers.cost)
        with clock.stage("planning"):
            refinement = _next_refinement(table, best)
            if isinstance(refinement, str):  # the reason why there is none
                return table_of_passes(passes, table, refinement)
            reason = _refusal(refinement, passes, shared.run.cache)
        if reason:
            return table_of_passes(passes, table, reason)
        if shared.on_draft is not None:
            shared.on_draft(table, refinement.text)
        last = shared.refined(refinement, clock)
        passes.append(last)
        if last.table is None:
            return table_of_passes(passes, table, f"pass {len(passes)} ({last.name}) failed: {last.failure}")
        if last.quality >= best.quality:
            what = "solve more points" if best.failed else "lower the measured errors"
            reason = f"pass {len(passes)} ({refinement.text}) did not {what}"
            return table_of_passes(passes, table, reason)
        best, table = last, last.table


def _next_refinement(table: SteDatabase, last: Pass) -> Refinement | str:
    """Return the refinement after a pass, or the reason why there is none."""
    tolerance = last.decision.checked.request.options.allowed
    if table.metadata.receipt["tolerance"]["met"]:
        return "met"
    behind = last.decision.behind if last.refinement is None else None
    if table.n_failed:
        return _behind_trial(behind, last) if behind else finer_mesh(last.decision, table.n_failed)
    at_nodes = table.metadata.receipt["tolerance"]["used_at_nodes"]
    if at_nodes is not None and at_nodes <= 1.0:  # the errors that finer meshes lower meet the tolerance
        return _interval_reason(table)
    # finer meshes lower these errors at nodes; the errors of the model stay
    reducible, _ = reducible_shares(error_shares(table, tolerance), last.decision.checked.request)
    measured = next_pass(last.decision, reducible)
    if behind and (isinstance(measured, str) or measured.expected > 1.0):
        return _behind_trial(behind, last)
    return measured


def _behind_trial(decision: Decision, trial: Pass) -> Refinement:
    """Return the pass that was expected to follow a trial, where one step from the trial is not enough."""
    expected = decision.mesh.option.error.reducible / decision.checked.request.options.allowed.relative
    name = f"{decision.checked.model_name}, {decision.mesh.option.name}"
    return Refinement(decision, "trial", (f"{trial.name} -> {name}",), expected)


def _interval_reason(table: SteDatabase) -> str:
    """Return text on the intervals whose error of interpolation, which no mesh lowers, is too large."""
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


def _refusal(refinement: Refinement, passes: Sequence[Pass], cache: Path | None) -> str:
    """Return the limit of passes or of time that forbids a refinement, as text; empty if none does."""
    if len(passes) == MAX_PASSES:
        return f"the limit is {MAX_PASSES} passes"
    budget = refinement.decision.checked.request.options.time_budget
    if budget is None:
        return ""
    left = budget - sum(done.cost["cpu_seconds"] for done in passes)
    needed = refinement.decision.predicted(cache).cpu_seconds
    if needed <= left:
        return ""
    return (
        f"{refinement.text} is predicted to take {engineering(needed, 2)} "
        f"CPU s; {engineering(max(left, 0.0), 2)} of {budget:.3g} are left"
    )
