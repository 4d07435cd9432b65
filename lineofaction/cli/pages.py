"""``loa geometry``, ``loa report`` and ``loa compare``: data sheets and pages."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import ValidationError

from bounds import engineering
from bounds.types import Json
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import PairFacts
from host.directories import cache_home
from lineofaction.cli.output import FOUND, Report, check_writable, console, print_json, progress_bar, table
from lineofaction.cli.run_study import run_study
from lineofaction.cli.subjects import assessed_case
from lineofaction.cli.verb_warnings import messages, warn
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.number_list import number_list
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import about, file_of, results_by_part, results_in
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.result_files import stamped
from lineofaction.gearbox.schemas import Case, read_model, read_table, validated
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.units import UM
from lineofaction.report.binding import bound
from lineofaction.report.comparison.compare import compare
from lineofaction.report.comparison.recorded import Measurement
from lineofaction.report.document import (
    Inputs,
    nominal_force,
    page_beside,
    page_of,
    read_inputs,
    write_whole,
)
from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.image import png, svg
from lineofaction.report.drawing.page import Page
from lineofaction.report.pair import (
    data_sheet,
    data_sheet_json,
    data_sheet_section,
    pair_drawing,
    pair_lead,
    pair_remarks,
    pair_title,
)
from lineofaction.report.run.view import RunView
from lineofaction.report.ste.curves import aligned, headline_load
from lineofaction.report.title_block import about_of, titled

if TYPE_CHECKING:
    from fe_contact.analysis.flanks.load_distribution import LoadDistribution

_ENDINGS = (".html", ".png", ".svg")
_WORDS = ("quantity", "symbol", "unit", "point")


def run_geometry(file: InputFile, output: Path | None, *, as_json: bool) -> None:
    """Print the data sheet of a case; draw it if requested."""
    checked = assessed_case(file)
    pair = checked.pair
    implausible = messages()
    warn(pair_remarks(pair))
    if output is not None:
        _write_sheet(pair, checked.case.errors.misalignment_class, output, implausible)
    if as_json:
        written = {} if output is None else {"written": str(output)}
        print_json(written | data_sheet_json(pair))
    else:
        _show_sheet(pair, output)


def _write_sheet(
    pair: ParallelAxes, tolerance_class: int | None, output: Path, implausible: list[str]
) -> None:
    if output.suffix not in _ENDINGS:
        raise BadInput.of("output", str(output), f"a file ending in one of {', '.join(_ENDINGS)}")
    check_writable(output)
    if output.suffix == ".html":
        facts = PairFacts.of(pair)
        page = Page(pair_title(facts), pair_lead(facts), (), (data_sheet_section(pair, tolerance_class),))
        write_whole(page, output, warnings=implausible)
    else:
        output.write_bytes({".png": png, ".svg": svg}[output.suffix](pair_drawing(pair, tolerance_class)))


def _show_sheet(pair: ParallelAxes, output: Path | None) -> None:
    out = console()
    title, ratios = _summary(pair)
    out.print(title, soft_wrap=True, style=FOUND)
    out.print(ratios, soft_wrap=True)
    for part in data_sheet(pair):
        out.print()
        out.print(table(part.head, part.rows, part.caption, words=_WORDS))
    if output is not None:
        out.print(f"written to {output}", soft_wrap=True)


def _summary(pair: ParallelAxes) -> tuple[str, str]:
    facts = PairFacts.of(pair)
    transverse, overlap = pair.active_contact_ratio, pair.overlap_ratio
    ratios = f"contact ratio {transverse:.3f} + {overlap:.3f} = {transverse + overlap:.3f}"
    backlash = f"circumferential backlash {number(pair.circumferential_backlash / UM, 3)} µm"
    return f"{pair_title(facts)}: {pair_lead(facts)}", f"{ratios}; {backlash}"


# ``loa report``.


@dataclass(frozen=True)
class ReportOptions:
    """How ``loa report`` writes: the folder of the pictures, what it is about, pictures in place of plots."""

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
    """Write page and pictures; of a folder with several cases what each says stands side by side."""
    projects = [name for name in named if name.is_dir()]
    block = options.about or next(filter(None, map(about, projects)), None)
    told = None if block is None else about_of(block)
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
    whole = titled(bound(pages), told)
    written = write_whole(whole, output, options.images, still_only=options.still)
    if as_json:
        print_json({"file": str(output), "written": [str(path) for path in written]})
        return
    for words in (*whole.alarms, *(whole.block.verdicts if whole.block else ())):
        console().print(words, soft_wrap=True)
    for path in written:
        console().print(f"written to {path}", soft_wrap=True)


def _by_part(named: Sequence[Path]) -> dict[str, list[Path]]:
    """Return the results by the case whose they are, of a folder alone; others by an empty text."""
    if len(named) == 1 and named[0].is_dir() and (by_part := results_by_part(named[0])):
        return {part.replace("_", " "): files for part, files in by_part.items()}
    return {"": [file for name in named for file in (results_in(name) if name.is_dir() else [name])]}


def _with_flanks(read: Inputs, *, quiet: bool) -> Inputs:
    """Return inputs with the flank results that belong to their table."""
    with progress_bar() as report:
        found = _flanks(read, report)
    if not quiet:
        console().print(f"flank results {engineering(found.metadata.receipt['cpu_seconds'], 3)} CPU s")
    flanks = page_beside(STUDIES["flank"], found, read.database)
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
        advice = "It was made in Python: write the file with flank_results(...).to_netcdf, and name it."
        raise BadInput.of("--flank", True, "given with the database of a case file", advice) from None
    misalignment, change = aligned(database)
    point = FlankPoint(
        normal_force_n=float(database.force[headline_load(database, nominal_force(read))]),
        misalignment_um=1e6 * misalignment,
        center_distance_change_mm=1e3 * change,
    )
    found: LoadDistribution = STUDIES["flank"].run.compute(
        CheckedCase(case_at(case, point)), point, Means(cache_home(), report)
    )
    return found


# ``loa compare``.


@dataclass(frozen=True)
class FlankQuestion:
    """What ``loa compare BEFORE AFTER --scene SCENE`` was called with, as typed."""

    scene: Path
    mesh: str | None
    tolerances: Path | None
    load_cases: Path | None
    speed_rpm: str | None
    requirement_db: float | None


def run_compare_flanks(
    files: Sequence[Path], question: FlankQuestion, output: Path, *, as_json: bool
) -> None:
    """Run the study of a change of flanks: of two case files, over the tolerances of a file."""
    if len(files) > 2:
        bound = (
            "the case files of the flanks before and after, or of those after alone: before are the scene's"
        )
        raise BadInput.of("files", [str(file) for file in files], bound)
    if question.speed_rpm is None:
        raise BadInput.of(
            "--speed-rpm", None, "given beside a scene", "For example --speed-rpm 500:6000:100."
        )
    *before, after = (read_model(Case, file) for file in files)
    inputs: Json = {
        "before": next(iter(before), None),
        "after": after,
        "mesh": question.mesh,
        "speed_rpm": number_list("--speed-rpm", question.speed_rpm),
        "requirement_db": question.requirement_db,
    }
    study = STUDIES["change"]
    if question.tolerances is not None:
        inputs["tolerances"] = read_table(question.tolerances)
    if question.load_cases is not None:
        inputs |= read_table(question.load_cases)
    options = {
        "scene": file_of(InputFile(question.scene), "scene"),
        "study": validated(study.inputs, inputs),
        "output": output,
    }
    run_study(study, options | {"workers": 1, "scheduler": None, "json": as_json})


def run_compare(
    files: Sequence[Path],
    output: Path,
    view: RunView,
    of: tuple[float | None, Measurement],
    *,
    as_json: bool,
) -> None:
    """Write the page; print what differs and what is not shown to; `of` are the torque and the recording."""
    check_writable(output)
    page = compare(files, view, *of)
    write_whole(page, output)
    if as_json:
        found = {line.name: {"difference": line.value, "finding": line.remark} for line in page.headlines}
        print_json({"file": str(output), "differences": found})
        return
    said = (f"{line.name}: {line.value}: {line.remark}" for line in page.headlines)
    for line in (*said, page.lead, f"written to {output}"):
        console().print(line, soft_wrap=True)
