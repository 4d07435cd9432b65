"""The report from result files: reading, the page, its JSON, and the written files."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from bounds.types import Json
from dynamics.errors import DynamicsError
from dynamics.results import RunResult
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from host.directories import atomic_file
from lineofaction.gearbox.convert.complaint import marks_of_case
from lineofaction.gearbox.problems import BadInput, DamagedFile
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.result_figures import making_of
from lineofaction.gearbox.result_files import COMPLAINT, stamped
from lineofaction.gearbox.studies.bodies import UNIT
from lineofaction.gearbox.study import Study
from lineofaction.report.drawing.attaching import attached
from lineofaction.report.drawing.figure import Figure, Table, half_figures, panel_rows
from lineofaction.report.drawing.image import png, still
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.marks import Marks, marked_page_of_case, marked_sections, marks_of, of_run
from lineofaction.report.drawing.page import Headline, Page, Section, html, sound_json
from lineofaction.report.drawing.printing import pdf
from lineofaction.report.drawing.tables import one_effects_section
from lineofaction.report.pair import pair_lead, pair_title
from lineofaction.report.presentation import presentation_of
from lineofaction.report.run.page import dynamic_alarms, dynamic_headlines, dynamic_making, dynamic_results
from lineofaction.report.run.view import RunView
from lineofaction.report.ste.headlines import static_headlines
from lineofaction.report.ste.page import static_alarms, static_making, static_results
from lineofaction.report.unit_picture import is_picture, one_picture, picture_sections
from model_studies.netcdf import UnreadableFile, opened_netcdf

_ACROSS, _OF_MANY, _MANY = 2, 3, 5  # panels beside each other on a page, also of a figure with many
_BOUND = f"an STE database, a run, or the result of a study ({', '.join(STUDIES)})"
_READERS: dict[str, tuple[tuple[str, str], Callable[[Path], Any]]] = {
    "database": (("format", "lineofaction STE database"), SteDatabase.from_netcdf),
    "run": (("schema", "lineofaction dynamics run"), RunResult.from_netcdf),
}
"""Attribute that identifies a file, and the reader of the file, by kind."""


def stored_study(attributes: Mapping[str, object]) -> Study | None:
    """Return the study that made a file with these attributes; None: another kind of file."""
    return next((study for study in STUDIES.values() if study.run.file.holds(attributes)), None)


def _study_page(study: Study, file: Path, database: SteDatabase | None) -> Page:
    result = read_stored(study, file)
    page = page_with_database(study, result, database)
    complaint = file_attributes(file).get(COMPLAINT)
    return page if complaint is None or marks_of(result) else marked_page_of_case(page, json.loads(complaint))


def read_stored(study: Study, file: Path) -> Any:
    """Return the result in a study's file; raises `BadInput`: it is damaged."""
    try:
        return study.run.file.read(file)
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", f"{error}.") from None
    except ValueError:
        remedy = "Something is missing or not as written."
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", remedy) from None


def page_with_database(study: Study, result: object, database: SteDatabase | None) -> Page:
    """Return the page of a study's result, together with its database if there is one."""
    presentation = presentation_of(study)
    if database is None or presentation.with_database is None:
        return presentation.page(result)
    return presentation.with_database(result, database)


@dataclass(frozen=True)
class Inputs:
    """The results of a report, at least one."""

    database: SteDatabase | None = None
    run: RunResult | None = None
    pages: Mapping[str, Page] = field(default_factory=dict)
    """Pages of studies by the kind of their results."""
    warnings: tuple[str, ...] = ()
    """Warnings of all files, in words."""
    view: RunView = field(default_factory=RunView)
    """Signal of the run that is shown, and how."""
    marks: Marks | None = None
    """Complaint of the run's scene."""
    unit: list[Json] | None = None
    """Bodies as which the run's scene is drawn."""
    records: Mapping[str, Json] = field(default_factory=dict)
    """Inputs and versions of each file, by its name."""

    @property
    def only_page(self) -> Page | None:
        """The page of a study, if nothing else was read."""
        alone = len(self.pages) == 1 and self.database is None and self.run is None
        return next(iter(self.pages.values())) if alone else None


def read_inputs(files: Sequence[Path]) -> Inputs:
    """Read every file by its kind.

    Raises `BadInput`: a file is neither, is damaged, there are two of a kind, or there is none at all.
    """
    if not files:
        raise BadInput.of("file", None, _BOUND, "Name at least one file.")
    by_kind: dict[str, tuple[Study | None, Path]] = {}
    for file in files:
        study, kind = _kind(file)
        if kind in by_kind:
            remedy = "One page shows one file of each kind."
            raise BadInput.of("file", str(file), f"the only {kind}", remedy)
        by_kind[kind] = study, file
    warnings = tuple(dict.fromkeys(entry["message"] for file in files for entry in stamped(file)))
    read = {kind: _read(file, kind) for kind, (study, file) in by_kind.items() if study is None}
    database = read.get("database")
    pages = {}
    for study in STUDIES.values():
        if study.kind in by_kind:
            pages[study.kind] = _study_page(study, by_kind[study.kind][1], database)
    attributes = file_attributes(by_kind["run"][1]) if "run" in read else {}
    marks, unit = (json.loads(attributes.get(name, "null")) for name in (COMPLAINT, UNIT))
    records = {file.name: making_of(file) for file in files}
    return Inputs(**read, pages=pages, warnings=warnings, marks=marks, unit=unit, records=records)


def read_result(file: Path) -> SteDatabase | RunResult:
    """Read a table or a run; raises `BadInput`: the file is neither, or is damaged."""
    study, kind = _kind(file)
    if study is not None:
        raise BadInput.of("result", f"{file.name}, which holds {kind}", "an STE database or a run")
    result: SteDatabase | RunResult = _read(file, kind)
    return result


def read_file(file: Path) -> Any:
    """Read a table, a run or the result of a study; raises `BadInput`: the file is none, or is damaged."""
    study, kind = _kind(file)
    return _read(file, kind) if study is None else read_stored(study, file)


def read_run(file: Path, field: str) -> RunResult:
    """Read a run, which `field` names; raises `BadInput`: the file is none, or is damaged."""
    result = read_result(file)
    if not isinstance(result, RunResult):
        raise BadInput.of(field, str(file), "a run", "It holds an STE database: loa simulate makes runs.")
    return result


def _kind(file: Path) -> tuple[Study | None, str]:
    """Return the study that made a file, if one did, and the kind of the file."""
    attributes = file_attributes(file)
    for kind, ((name, value), _) in _READERS.items():
        if attributes.get(name) == value:
            return None, kind
    study = stored_study(attributes)  # loads what computes studies
    if study is not None:
        return study, study.kind
    raise BadInput.of("file", str(file), _BOUND, "It is a netCDF file of another kind.")


def file_attributes(file: Path) -> dict[str, str]:
    """Return the attributes of a netCDF file as texts.

    Raises `BadInput`: the file is missing or no netCDF-4 file.
    """
    if not file.is_file():
        what = "It is a folder" if file.is_dir() else "There is no such file"
        raise BadInput.of("file", str(file), _BOUND, f"{what}. Check the path.")
    if file.suffix == ".json":
        remedy = "JSON is for programs. Name the netCDF file: the verb writes it with -o FILE.nc."
        raise BadInput.of("file", str(file), _BOUND, remedy)
    try:
        with opened_netcdf(file) as content:
            return {name: str(value) for name, value in content.attrs.items()}
    except UnreadableFile as error:
        raise BadInput.of("file", str(file), _BOUND, f"{error}.") from None


def _read(file: Path, kind: str) -> Any:
    try:
        return _READERS[kind][1](file)
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {kind}", f"{error}.") from None


def page_of(read: Inputs) -> Page:
    """Return the page: warnings, then all sections in the order of their parts.

    A study alone has its own page.
    """
    page = _page_of(read)
    alarms = (*(f"Warning: {text}" for text in read.warnings), *page.alarms)
    sections = _without_repeated_figures(one_effects_section(one_picture(page.sections)))
    sections.sort(key=lambda section: section.part)
    return replace(page, alarms=alarms, sections=tuple(sections), records=read.records)


def _without_repeated_figures(sections: Sequence[Section]) -> list[Section]:
    """Return sections in which a figure that several studies draw alike, with one finding, stands once."""
    seen: set[tuple[str, str]] = set()
    unique = []
    for section in sections:
        figures = []
        for figure in section.figures:
            if (figure.key, figure.alternative) not in seen:
                figures.append(figure)
            seen.add((figure.key, figure.alternative))
        unique.append(replace(section, figures=tuple(figures)))
    return unique


def _page_of(read: Inputs) -> Page:
    """Return the page without the warnings of the files."""
    if read.only_page is not None:
        return read.only_page
    database, run = read.database, read.run
    sections: list[Section] = []
    alarms: list[str] = []
    if database is not None:
        results = static_results(database, nominal_force(read))
        sections += (*_marked_table(results, read), *static_making(database))
        alarms += static_alarms(database)
    for study in read.pages.values():
        sections += study.sections
        alarms += study.alarms
    if run is not None:
        sections += (*picture_sections(read.unit), *_marked_results(run, read), *dynamic_making(run))
        alarms += dynamic_alarms(run)
    parts = []
    if read.database is not None:
        parts.append(pair_lead(read.database.geometry))
    elif len(read.pages) == 1:
        parts += [page.lead for page in read.pages.values() if page.lead]
    if read.run is not None:
        parts.append(f"{read.run.time[-1]:.6g} s of motion at {read.run.sample_rate:.6g} samples per second")
    lead = "; ".join(parts)
    marks = _complaint_of(read)
    if marks is not None:
        lead = " ".join(filter(None, (lead and f"{lead}.", f"Complaint: {marks['words']}.")))
    return Page(_title(read), lead, headlines_of(read), tuple(sections), tuple(alarms))


def _complaint_of(read: Inputs) -> Marks | None:
    """Return the complaint of the table's case, or of the run's scene."""
    of_case = None if read.database is None else marks_of_case(read.database.metadata.case)
    return of_case or read.marks


def _marked_results(run: RunResult, read: Inputs) -> tuple[Section, ...]:
    """Return the results of a run, in whose plots the complaint of its scene is marked."""
    results = tuple(dynamic_results(run, read.view))
    mesh = read.view.mesh or next(iter(run.mesh), "")
    return results if read.marks is None else marked_sections(results, of_run(read.marks, mesh))


def _marked_table(results: tuple[Section, ...], read: Inputs) -> tuple[Section, ...]:
    """Return the results of a table with the complaint of its case, or of a run's scene, in the plots."""
    marks = _complaint_of(read)
    if marks is None:
        return results
    mesh = read.view.mesh or next(iter(marks["meshes"]), "")
    return marked_sections(results, of_run(marks, mesh))


def headlines_of(read: Inputs) -> tuple[Headline, ...]:
    """Return the main figures of the table, of the studies, and of the run."""
    of_studies = [headline for study in read.pages.values() for headline in study.headlines]
    headlines: list[Headline] = []
    if read.database is not None:
        headlines += static_headlines(read.database, nominal_force(read))
        # flank results have the pressure with its error
        flank = {line.name.replace("flank pressure", "pressure") for line in of_studies}
        headlines = [line for line in headlines if line.name not in flank]
    headlines += of_studies
    if read.run is not None:
        headlines += dynamic_headlines(read.run)
    return tuple(headlines)


def nominal_force(read: Inputs) -> float | None:
    """Return the normal force in N that the run's load asks of the database's pair; None where it idles."""
    if read.run is None or read.database is None or read.run.nominal_force[0] <= 0.0:
        return None
    return float(read.run.nominal_force[0]) / math.cos(read.database.geometry.base_helix_angle)


def _title(read: Inputs) -> str:
    if read.database is not None:
        return pair_title(read.database.geometry)
    if not read.pages:
        return "Dynamics of geared shafts"
    titles = {page.title for page in read.pages.values()}
    if len(titles) == 1:
        return titles.pop()
    subjects = " or ".join(study.takes.subject for study in STUDIES.values() if study.kind in read.pages)
    return f"Studies of a {' and a '.join(sorted(set(subjects.split(' or '))))}"


def stored_figures(inputs: Json) -> Json:
    """Return the report on a stored result: ``{"file": ..., "printed": bool}``; work of the live worker."""
    with of_the_store():
        return page_json(page_of(read_inputs([Path(inputs["file"])])), printed=inputs.get("printed", False))


def _figures(page: Page) -> list[Figure]:
    return [figure for section in page.sections for figure in section.figures]


@contextmanager
def of_the_store() -> Iterator[None]:
    """Turn the refusal of a file into `DamagedFile`, which does not say where the file is."""
    try:
        yield
    except BadInput as error:
        if not any(fault.field == "file" for fault in error.faults):
            raise
        reasons = "; ".join(f"{fault.bound}. {fault.suggestion}" for fault in error.faults)
        raise DamagedFile(f"The stored file is not {reasons}") from None


def page_json(page: Page, *, printed: bool = False) -> Json:
    """Return a report as plain JSON, without the picture of a unit: programs have its bodies.

    `printed`: its page in place of its parts, of pictures alone: ``{"page": HTML}``.
    """
    if printed:
        stills = {key: still(image) for key, image in _drawn(page).items()}
        return {"page": html(page, stills, still=True)}
    return {
        "title": page.title,
        "lead": page.lead,
        "alarms": list(page.alarms),
        "headlines": [{"name": h.name, "value": h.value, "remark": h.remark} for h in page.headlines],
        "sections": [_section(section) for section in page.sections if not is_picture(section)],
    }


def _section(section: Section) -> Json:
    return {
        "title": section.title,
        "part": section.part.name.lower(),
        "text": section.text,
        "figures": [_figure(figure) for figure in section.figures],
        "tables": list(map(_table, section.tables)),
        "folded": list(map(_table, section.folded)),
    }


def _figure(figure: Figure) -> Json:
    return {
        "key": figure.key,
        "title": figure.title,
        "caption": figure.caption,
        "alternative": figure.alternative,
        "plot": plotly_figure(figure),
        "table": None if figure.table is None else _table(figure.table),
        "sound": None if figure.sound is None else sound_json(figure.sound),
    }


def _table(table: Table) -> Json:
    return {"caption": table.caption, "head": list(table.head), "rows": [list(row) for row in table.rows]}


def write_report(inputs: Path | Sequence[Path], output: Path, images: Path | None = None) -> list[Path]:
    """Write one HTML page that needs no network, and its plots as PNG; return the files, the page first.

    Raises `BadInput`: a file is none of them, is damaged, or there are two of a kind.

    Parameters
    ----------
    inputs : Path or sequence of Path
        STE databases, runs and results of studies, at most one of each kind; the file says which it is.
    output : Path
        The page; as PDF by its ending, without what is folded; case and receipt are a file in it.
    images : Path, optional
        Folder for the PNG files, made if missing; left out: none are written.
    """
    read = read_inputs([inputs] if isinstance(inputs, Path) else list(inputs))
    return write_page(page_of(read), output, images)


def write_page(
    page: Page,
    output: Path,
    images: Path | None = None,
    warnings: Sequence[str] = (),
    *,
    still_only: bool = False,
) -> list[Path]:
    """Write a page of the caller under its warnings; parameters as for `write_report`.

    `still_only`: its plots are pictures alone.
    """
    page = replace(page, alarms=(*(f"Warning: {text}" for text in warnings), *page.alarms))
    figures = _figures(page)
    printed = output.suffix == ".pdf"
    drawn = _drawn(page)
    stills = {key: still(image) for key, image in drawn.items()}
    text = html(page, stills, still=printed or still_only)
    content = _printed(page, text, output) if printed else text.encode("utf-8")
    with atomic_file(output) as draft:
        draft.write_bytes(content)
    written = [output]
    if images is not None:
        images.mkdir(parents=True, exist_ok=True)
        half = {key for section in page.sections for key in half_figures(section.figures)}
        for figure in figures:
            alone = all(len(row) == 1 for row in panel_rows(figure.content, _across(figure)))
            alone &= figure.key not in half
            with atomic_file(images / f"{figure.key}.png") as draft:
                draft.write_bytes(drawn[figure.key] if alone else png(figure))
            written.append(images / f"{figure.key}.png")
    return written


def _drawn(page: Page) -> dict[str, bytes]:
    """Draw the figures of a page as printed: panels beside each other, small figures on half the width."""
    images = {}
    for section in page.sections:
        half = half_figures(section.figures)
        for figure in section.figures:
            is_half = figure.key in half
            images[figure.key] = png(figure, across=1 if is_half else _across(figure), half=is_half)
    return images


def _across(figure: Figure) -> int:
    """Return how many panels of a figure stand beside each other on a page, if they are narrow."""
    return _OF_MANY if len(figure.content) >= _MANY else _ACROSS


def _printed(page: Page, text: str, output: Path) -> bytes:
    """Print a page; the inputs and versions of its results are attached as a file."""
    content = pdf(text, output)
    if not page.records:
        return content
    return attached(content, "receipts.json", json.dumps(page.records, indent=1).encode("utf-8"))


def facts(result: Any) -> dict[str, Any]:
    """Return the figures of a study's result in the units of their names, as its verb prints them as JSON."""
    figures: dict[str, Any] = study_of(result).run.figures(result)
    return figures


def write(result: Any, file: Path | str) -> Path:
    """Write a result: netCDF (.nc), figures (.json), the plot (.png) or the report (.html).

    Raises `BadInput`: the result has no file of this ending.

    Parameters
    ----------
    result : object
        Result of `analyze`, `simulate` or a study.
    file : path
        File whose ending names the form.
    """
    path = Path(file)
    if hasattr(result, "to_netcdf") and path.suffix == ".nc":
        result.to_netcdf(path)
        return path
    study = study_of(result)
    if path.suffix == ".nc":
        study.run.file.write(result, path)
    elif path.suffix == ".json":
        study.run.save_figures(result, path)
    elif path.suffix == ".png":
        path.write_bytes(png(presentation_of(study).figure(result)))
    elif path.suffix == ".html":
        write_page(presentation_of(study).page(result), path)
    else:
        raise BadInput.of("file", str(path), "a file ending in one of .nc, .json, .png, .html")
    return path


def study_of(result: Any) -> Study:
    """Return the study that makes results of this type; raises `BadInput`: none does."""
    for study in STUDIES.values():
        kind = study.run.file.result
        if isinstance(result, kind):
            return study
    kind = type(result).__name__
    remedy = "Tables and runs: write them to netCDF, then loa report."
    raise BadInput.of("result", kind, "the result of a study", remedy)
