"""The accuracy ladder at the boundary: from a case to its frontier."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from fe_contact.analysis.frontier import Frontier, frontier
from service.convert.case import analysis_arguments, boundary_errors, gear_pair
from service.schemas import Case

_LEFT_ASIDE = ("pitches", "receipt", "on_violation")


def frontier_of(
    case: Case,
    rungs: Sequence[str] | None,
    progress: Callable[[str, float], None] | None = None,
    *,
    full_contact: int | None = None,
) -> Frontier:
    """Run the ladder on a case, over all pitches that differ, with the whole receipt.

    `full_contact` positions are run by full finite-element contact beside it.

    Raises
    ------
    BadInput
        No such pair or rung.
    JobFailed
        Fewer than two rungs gave a table.
    """
    pair = gear_pair(case)
    asked = {name: value for name, value in analysis_arguments(case).items() if name not in _LEFT_ASIDE}
    with boundary_errors():
        return frontier(pair, **asked, fidelities=rungs, full_contact=full_contact, progress=progress)
