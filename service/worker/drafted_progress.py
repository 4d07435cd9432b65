"""Progress of an analysis that refines: the figures of the last draft stand in the stage that follows."""

from __future__ import annotations

from fe_contact.ste import SteDatabase
from service.convert.drafts import draft_line
from service.worker.order import Progress


class DraftedProgress:
    """Reports stages, with the last draft behind their names.

    Such a stage is none of those declared, so that the fraction of the whole job does not fall where a pass
    begins anew.

    Parameters
    ----------
    report : callable
        Called as report(stage, fraction).
    """

    def __init__(self, report: Progress) -> None:
        self._report, self._draft = report, ""

    def __call__(self, stage: str, fraction: float) -> None:
        """Report the fraction done of a stage."""
        self._report(f"{stage}; {self._draft}" if self._draft else stage, fraction)

    def draft(self, table: SteDatabase, refining: str) -> None:
        """Take the figures of a table that is being refined."""
        self._draft = draft_line(table, refining)
