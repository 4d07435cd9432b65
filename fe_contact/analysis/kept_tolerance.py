"""Plan, run, measure, refine what dominates: until the tolerance is met, or nothing brings it nearer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from fe_contact.analysis.compute_database import compute_pass
from fe_contact.analysis.model_choice import decide
from fe_contact.analysis.passes import Pass, of_all_passes
from fe_contact.analysis.refinement import Refinement, next_pass
from fe_contact.analysis.request import Checked
from fe_contact.analysis.tolerance_receipt import error_shares
from fe_contact.errors import FeContactError
from fe_contact.progress import Progress
from fe_contact.stage_clock import StageClock
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from fe_contact.workers import Workers

MOST_PASSES = 4

OnDraft = Callable[[SteDatabase, str], None]
"""Called with the table of a pass that is refined, and what is refined in words."""


@dataclass(frozen=True)
class _Run:
    """What all passes share."""

    case: Json
    report: Progress
    on_draft: OnDraft
    cache: Path
    workers: Workers

    def first(self, checked: Checked) -> Pass:
        """Run what the accuracy is expected to ask for."""
        clock = StageClock(self.workers.cost)
        with clock.stage("planning"):
            decided = decide(checked, self.cache, tried=True)
        shared = (self.case, self.report, self.cache)
        done = compute_pass(decided.checked, *shared, decided, self.workers, clock)
        return Pass(done.decided, done.table.metadata.receipt, done.table)

    def refined(self, made: Refinement, clock: StageClock) -> Pass:
        """Run a refinement; one that fails or is interrupted says so."""
        decided, shared = made.decided, (self.case, self.report, self.cache)
        try:
            done = compute_pass(decided.checked, *shared, decided, self.workers, clock)
        except KeyboardInterrupt:
            return Pass(decided, clock.to_json(), None, made, "interrupted")
        except (FeContactError, MemoryError) as error:
            return Pass(decided, clock.to_json(), None, made, str(error) or "out of memory")
        return Pass(done.decided, done.table.metadata.receipt, done.table, made)


def kept_tolerance(
    checked: Checked,
    case: Json,
    report: Progress,
    cache: Path | None,
    on_draft: OnDraft,
    workers: Workers,
) -> SteDatabase:
    """Compute the table of a request with a tolerance, in at most `MOST_PASSES` passes.

    Parameters
    ----------
    checked : Checked
        With a tolerance and a full receipt.
    case : dict
        Echoed into the result and hashed.
    report : callable
        Called as report(stage, fraction); every pass begins anew.
    cache : Path, optional
        Directory of flank compliances, which passes share; None: one for this run.
    on_draft : callable
        Called with every table that is refined, and what is refined.
    workers : Workers
        Who condenses the gears and solves the contact.

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
    if cache is not None:
        return _passes(checked, _Run(case, report, on_draft, cache, workers))
    with TemporaryDirectory() as folder:
        return _passes(checked, _Run(case, report, on_draft, Path(folder), workers))


def _passes(checked: Checked, run: _Run) -> SteDatabase:
    """Refine until there is a reason not to."""
    best = run.first(checked)
    passes = [best]
    assert best.table is not None
    table = best.table
    while True:
        clock = StageClock(run.workers.cost)
        with clock.stage("planning"):
            made = _following(table, best)
            reason = made if isinstance(made, str) else _ended(made, passes, run.cache)
        if isinstance(made, str) or reason:
            return of_all_passes(passes, table, reason)
        run.on_draft(table, made.words)
        last = run.refined(made, clock)
        passes.append(last)
        if last.table is None:
            return of_all_passes(passes, table, f"pass {len(passes)} ({last.name}) failed: {last.failure}")
        if last.used >= best.used:
            said = f"pass {len(passes)} ({made.words}) did not lower the measured errors"
            return of_all_passes(passes, table, said)
        best, table = last, last.table


def _following(table: SteDatabase, last: Pass) -> Refinement | str:
    """Return what to refine after a pass, or why nothing."""
    tolerance = last.decided.checked.request.accuracy.allowed
    if table.metadata.receipt["tolerance"]["met"]:
        return "met"
    if table.n_failed:
        return f"{table.n_failed} points failed"
    return next_pass(last.decided, error_shares(table, tolerance))


def _ended(made: Refinement, passes: Sequence[Pass], cache: Path) -> str:
    """Say why a refinement does not begin, of passes or of time; empty if it may."""
    if len(passes) == MOST_PASSES:
        return f"{MOST_PASSES} passes are the most"
    budget = made.decided.checked.request.accuracy.time_budget
    if budget is None:
        return ""
    left = budget - sum(one.cost["cpu_seconds"] for one in passes)
    needed = made.decided.predicted(cache).cpu_seconds
    if needed <= left:
        return ""
    return (
        f"{made.words} is predicted to take {needed:.2g} CPU s; {max(left, 0.0):.2g} of {budget:.3g} are left"
    )
