"""Tables of cases, computed in this process or by its workers."""

from __future__ import annotations

import sys

from fe_contact.ste import SteDatabase
from host.directories import cache_home
from lineofaction.cli.output import Report
from lineofaction.gearbox.convert.answers import draft_line
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.tabled_scene import database_of
from model_studies.workers import InProcess, Workers


def computed_table(
    case: CheckedCase,
    report: Report,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SteDatabase:
    """Compute the database of a case; condensed gears are kept in the user's cache.

    Figures of a table that is being refined are printed on standard error: they are progress.
    """

    def print_draft(table: SteDatabase, refining: str) -> None:
        print(draft_line(table, refining), file=sys.stderr, flush=True)  # noqa: T201 (this is the command line)

    return database_of(case, cache_home(), report, workers, print_draft)
