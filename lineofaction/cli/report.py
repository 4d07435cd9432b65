"""``loa report``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import ValidationError

from bounds import engineering
from host.directories import cache_home
from lineofaction.cli.output import Report, check_writable, console, print_json, progress_bar
from lineofaction.cli.warned import warn
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.stamp import stamped
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.flank import FlankPoint
from lineofaction.report.document.content import nominal_force
from lineofaction.report.document.inputs import Inputs, read_inputs
from lineofaction.report.document.stored_study import page_beside
from lineofaction.report.document.write import write_page
from lineofaction.report.runs.run_view import RunView
from lineofaction.report.tables.aligned import aligned, headline_load

if TYPE_CHECKING:
    from fe_contact.analysis import LoadDistribution


def run_report(
    files: Sequence[Path], output: Path, images: Path | None, view: RunView, *, flank: bool, as_json: bool
) -> None:
    """Write the page; draw the pictures and compute the flank results if requested."""
    for file in files:
        if not file.is_file():
            raise BadInput.of("file", str(file), "a file of results", "Check the path.")
    check_writable(output)
    read = replace(read_inputs(files), view=view)
    warn(warning for file in files for warning in stamped(file))
    spent = 0.0
    if flank:
        with progress_bar() as report:
            found = _flanks(read, report)
        page = page_beside(STUDIES["flank"], found, read.database)
        read = replace(read, pages={**read.pages, "flanks": page})
        spent = found.metadata.receipt["cpu_seconds"]
    written = write_page(read, output, images)
    if as_json:
        print_json({"file": str(output), "written": [str(path) for path in written]})
        return
    if flank:
        console().print(f"flank results {engineering(spent, 3)} CPU s", highlight=False)
    for path in written:
        console().print(f"written to {path}", highlight=False)


def _flanks(read: Inputs, report: Report) -> LoadDistribution:
    """Compute the flank results of the database's case, at the load and the alignment of the page's figures.

    Raises
    ------
    BadInput
        There is no database to take the case from, or flank results are there already.
    """
    from lineofaction.gearbox.studies.flank.run import flanks_of  # noqa: PLC0415 (start-up time)

    database = read.database
    if "flanks" in read.pages:
        raise BadInput.of("--flank", True, "left out with a file of flank results", "Name one or the other.")
    if database is None:
        raise BadInput.of("--flank", True, "given with an STE database", "Its case says what to compute.")
    try:
        # strict models take JSON's lists for tuples only from text
        case = Case.model_validate_json(json.dumps(database.metadata.case))
    except ValidationError:
        advice = "It was made in Python: write the file with flank_results(...).to_netcdf, and name it."
        raise BadInput.of("--flank", True, "given with the database of a case file", advice) from None
    misalignment, change = aligned(database)
    point = FlankPoint(
        normal_force_n=float(database.force[headline_load(database, nominal_force(read))]),
        misalignment_um=1e6 * misalignment,
        center_distance_change_mm=1e3 * change,
    )
    return flanks_of(case_at(case, point), cache_home() / "compliance", report)
