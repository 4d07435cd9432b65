"""Repetition of a run whose result shows that one of its assumptions does not hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeVar

from fe_contact.analysis.checks.assumptions import Assumption
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.analysis.request.solved_run import SolvedRun
from fe_contact.errors import SolveError
from fe_contact.types import Json
from model_studies.stage_clock import StageClock

Run = TypeVar("Run", bound=SolvedRun)


def settled(
    run: Run,
    check: Callable[[Run], tuple[Assumption, ...]],
    repeat: Callable[[Run, Mapping[str, str]], Run],
    clock: StageClock,
) -> tuple[Run, tuple[Assumption, ...], list[Json]]:
    """Check the assumptions of a run; where one is violated, act as the caller chose.

    An automatic effect that turns out to be needed is switched on and the run made `repeat` with the effects
    and reasons given. What was requested by name is only reported. Raises `SolveError`: an assumption does
    not hold and `on_violation` is "fail".

    Returns
    -------
    run
        The last one.
    assumptions : tuple of Assumption
        Of the last one.
    repeated : list of dict
        What was turned on each time, and the CPU seconds it took.
    """
    repeated: list[Json] = []
    while True:
        with clock.stage("assumptions"):
            assumptions = check(run)
        wrong = tuple(assumption for assumption in assumptions if assumption.holds is False)
        request = run.checked.request
        if wrong and request.options.on_violation == "fail":
            reasons = "; ".join(f"{flaw.what}: {flaw.reason}" for flaw in wrong)
            raise SolveError(f"violated assumptions: {reasons}")
        automatic = {entry.name for entry in run.checked.ledger if entry.choice == "auto" and not entry.on}
        needed = {flaw.effect: f"{flaw.what}: {flaw.reason}" for flaw in wrong if flaw.effect in automatic}
        if not needed or request.options.on_violation != "repeat":
            return run, assumptions, repeated
        before = sum(clock.seconds.values())
        run = repeat(run, needed)
        repeated.append({"turned_on": needed, "cpu_seconds": sum(clock.seconds.values()) - before})


def with_effects(checked: Checked, needed: Mapping[str, str], *, check_size: bool = True) -> Checked:
    """Return the request with effects switched on that a run showed to be needed."""
    request = checked.request
    reasons = {name: f"on after a run without it: {reason}" for name, reason in needed.items()}
    neglected = {name: reason for name, reason in request.neglected.items() if name not in needed}
    turned_on = {**request.turned_on, **reasons}
    return checked_request(replace(request, neglected=neglected, turned_on=turned_on), check_size=check_size)
