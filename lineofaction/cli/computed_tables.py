"""Tables of cases, computed in this process or by its workers."""

from __future__ import annotations

import sys

from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.answers import draft_line
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.tabled_scene import checked_table


def computed_table(case: CheckedCase, run: Run) -> SteDatabase:
    """Compute the database of a case.

    Figures of a table that is being refined are printed on standard error: they are progress.
    """

    def print_draft(table: SteDatabase, refining: str) -> None:
        print(draft_line(table, refining), file=sys.stderr, flush=True)  # noqa: T201 (this is the command line)

    return checked_table(case, run, print_draft)
