"""Progress of an analysis: its fraction by predicted cost, and the figures of the last draft."""

from __future__ import annotations

from collections.abc import Mapping

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.drafts import draft_line
from lineofaction.gearbox.stages import TableFraction
from service.worker.order import Progress


class DraftedProgress:
    """Reports stages, with the last draft behind their names, and the fraction of the whole table.

    Parameters
    ----------
    report : callable
        Called as report(stage, fraction, whole).
    refines : bool
        Whether passes may follow the first.
    """

    def __init__(self, report: Progress, *, refines: bool) -> None:
        self._report, self._draft = report, ""
        self._table = TableFraction(refines=refines)

    def __call__(self, stage: str, fraction: float) -> None:
        """Report the fraction done of a stage."""
        name = f"{stage}; {self._draft}" if self._draft else stage
        self._report(name, fraction, self._table.at(stage, fraction))

    def plan(self, stages: Mapping[str, float]) -> None:
        """Take the predicted cost of the stages of a pass."""
        self._table.plan(stages)

    def draft(self, table: SteDatabase, refining: str) -> None:
        """Take the figures of a table that is being refined."""
        self._draft = draft_line(table, refining)
