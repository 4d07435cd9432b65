"""The accuracy ladder at the boundary: from a case to its frontier."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fe_contact.analysis.frontier import Frontier, frontier
from fe_contact.progress import Progress, silent
from service.convert.case import boundary_errors, gear_pair, study_options, table_axes
from service.schemas import Case


def frontier_of(
    case: Case,
    rungs: Sequence[str] | None,
    progress: Progress = silent,
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
    axes = replace(table_axes(case), pitches=None)
    with boundary_errors():
        return frontier(
            pair, axes, study_options(case), fidelities=rungs, full_contact=full_contact, progress=progress
        )
