"""Assumptions of a condensed pair's table: what costs nothing is checked, the rest is named."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from fe_contact.analysis.checks.assumptions import Assumption, SolvedRun, check_cheaply
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.request.request import Checked
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.planning import Plan


@dataclass(frozen=True)
class CondensedRun:
    """A table of a condensed pair as its checks see it, after `SolvedRun`."""

    checked: Checked
    plan: Plan
    places: OperatingPoints
    solved: Sequence[tuple[ContactProblem, ContactSolution]]


def check_condensed(run: SolvedRun, neglected: Mapping[str, str]) -> tuple[Assumption, ...]:
    """Check what can be checked on the solution alone.

    Parameters
    ----------
    run : SolvedRun
    neglected : mapping of str to str
        Effects of the bodies that the tolerance of the table's case neglected, and why: off here too.

    Returns
    -------
    tuple of Assumption
        What was not checked has no verdict (`holds` None) and says so.
    """
    return (*check_cheaply(run), *_edges(run), *_neglected(neglected))


def _edges(run: SolvedRun) -> Iterator[Assumption]:
    """Without corner contact: edges would have to be laid out, which assembles another compliance."""
    if not run.checked.model.corner_contact:
        reason = "not checked: corner contact is switched off by the case"
        effect = run.checked.request.named("corner_contact")
        yield Assumption(effect, "tip edges stay clear", None, float("nan"), reason)


def _neglected(neglected: Mapping[str, str]) -> Iterator[Assumption]:
    """Effects of the bodies that were neglected for a tolerance, assessed by the flanks of the case."""
    for name, why in neglected.items():
        reason = f"not checked on these flanks: {why}"
        yield Assumption(name, "neglected effects are negligible", None, float("nan"), reason)
