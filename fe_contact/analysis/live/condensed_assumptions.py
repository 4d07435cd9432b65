"""Assumptions of a condensed pair's table: some are checked on its solution, the others are named."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fe_contact.analysis.checks.assumptions import Assumption
from fe_contact.analysis.request.solved_run import SolvedRun


def edge_assumptions(run: SolvedRun) -> Iterator[Assumption]:
    """Without corner contact: edges would have to be laid out, which assembles another compliance."""
    if not run.checked.model.corner_contact:
        reason = "not checked: corner contact is switched off by the case"
        effect = run.checked.request.named("corner_contact")
        yield Assumption(effect, "tip edges stay clear", None, float("nan"), reason)


def neglected_assumptions(neglected: Mapping[str, str]) -> Iterator[Assumption]:
    """Effects of the bodies that were neglected for a tolerance, assessed by the flanks of the case."""
    for name, why in neglected.items():
        reason = f"not checked on these flanks: {why}"
        yield Assumption(name, "neglected effects are negligible", None, float("nan"), reason)
