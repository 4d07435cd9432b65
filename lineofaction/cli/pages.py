"""``loa report``: pages of results, cases and scenes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import ValidationError

from bounds import engineering
from host.directories import cache_home
from lineofaction.cli.output import Report, check_writable, console, print_json
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.project import about, results_by_part, results_in
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.result_files import stamped
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.studies.computation import Means
from lineofaction.report.binding import bound
from lineofaction.report.document import (
    Inputs,
    nominal_force,
    page_of,
    page_with_database,
    read_inputs,
    write_page,
)
from lineofaction.report.run.view import RunView
from lineofaction.report.ste.curves import aligned, headline_load
from lineofaction.report.title_block import about_of, titled

if TYPE_CHECKING:
    from fe_contact.analysis.flanks.load_distribution import LoadDistribution


@dataclass(frozen=True)
class ReportOptions:
    """Options of ``loa report``: the folder of pictures, the file that names the subject, still pictures."""

    images: Path | None
    about: Path | None
    still: bool


def run_report(
    named: Sequence[Path],
    page: Path | None,
    options: ReportOptions,
    view: RunView,
    *,
    flank: bool,
    as_json: bool,
) -> None:
    """Write page and pictures; results of several cases of a folder stand side by side."""
    projects = [name for name in named if name.is_dir()]
    block = options.about or next(filter(None, map(about, projects)), None)
    title_block = None if block is None else about_of(block)
    by_part = _by_part(named)
    output = page or next(iter(projects), Path()) / "report.html"
    for file in (file for files in by_part.values() for file in files):
        if not file.is_file():
            raise BadInput.of("file", str(file), "a file of results", "Check the path.")
    check_writable(output)
    pages = {}
    for part, files in by_part.items():
        read = replace(read_inputs(files), view=view)
        warn(warning for file in files for warning in stamped(file))
        with_table = flank and (read.database is not None or len(by_part) == 1)
        pages[part] = page_of(_with_flanks(read, quiet=as_json) if with_table else read)
    report = titled(bound(pages), title_block)
    written = write_page(report, output, options.images, still_only=options.still)
    if as_json:
        print_json({"file": str(output), "written": [str(path) for path in written]})
        return
    for line in (*report.alarms, *(report.block.verdicts if report.block else ())):
        console().print(line, soft_wrap=True)
    for path in written:
        console().print(f"written to {path}", soft_wrap=True)


def _by_part(named: Sequence[Path]) -> dict[str, list[Path]]:
    """Return the results of a single folder by case; all others under an empty text."""
    if len(named) == 1 and named[0].is_dir() and (by_part := results_by_part(named[0])):
        return {part.replace("_", " "): files for part, files in by_part.items()}
    return {"": [file for name in named for file in (results_in(name) if name.is_dir() else [name])]}


def _with_flanks(read: Inputs, *, quiet: bool) -> Inputs:
    """Return inputs with the flank results that belong to their table."""
    with progress_bar() as report:
        flank_result = _flanks(read, report)
    if not quiet:
        console().print(f"flank results {engineering(flank_result.metadata.receipt['cpu_seconds'], 3)} CPU s")
    flanks = page_with_database(STUDIES["flank"], flank_result, read.database)
    return replace(read, pages={**read.pages, "flanks": flanks})


def _flanks(read: Inputs, report: Report) -> LoadDistribution:
    """Compute the flank results of the database's case, at the load and the alignment of the page's figures.

    Raises `BadInput`: there is no database to take the case from, or flank results are there already.
    """
    database = read.database
    if "flank" not in STUDIES:
        raise BadInput.of("--flank", True, "left out", "This installation has no study of flanks.")
    if "flanks" in read.pages:
        raise BadInput.of("--flank", True, "left out with a file of flank results", "Name one or the other.")
    if database is None:
        raise BadInput.of("--flank", True, "given with an STE database", "Its case says what to compute.")
    try:
        # strict models take JSON's lists for tuples only from text
        case = Case.model_validate_json(json.dumps(database.metadata.case))
    except ValidationError:
        remedy = "It was made in Python: write the file with flank_results(...).to_netcdf, and name it."
        raise BadInput.of("--flank", True, "given with the database of a case file", remedy) from None
    misalignment, change = aligned(database)
    point = FlankPoint(
        normal_force_n=float(database.force[headline_load(database, nominal_force(read))]),
        misalignment_um=1e6 * misalignment,
        center_distance_change_mm=1e3 * change,
    )
    result: LoadDistribution = STUDIES["flank"].run.compute(
        CheckedCase(case_at(case, point)), point, Means(cache_home(), report)
    )
    return result
