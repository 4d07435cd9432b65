"""The content of the page, by what was read, and as the plain JSON that a service's page shows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput, DamagedFile
from lineofaction.report.document.inputs import Inputs, read_inputs
from lineofaction.report.drawing.figure import Figure, Table
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.page import Headline, Page, Section, sound_json
from lineofaction.report.drawing.tables import one_effects_section
from lineofaction.report.runs.dynamic_part import (
    dynamic_alarms,
    dynamic_headlines,
    dynamic_making,
    dynamic_results,
)
from lineofaction.report.tables.pair import pair_lead, pair_title
from lineofaction.report.tables.static_part import (
    static_alarms,
    static_headlines,
    static_making,
    static_results,
)


def page_of(read: Inputs) -> Page:
    """Put the page together: what is implausible, then all sections in the order of their parts.

    A study alone has its own page.
    """
    page = _page_of(read)
    alarms = (*(f"Warning: {text}" for text in read.warnings), *page.alarms)
    sections = sorted(one_effects_section(page.sections), key=lambda section: section.part)
    return replace(page, alarms=alarms, sections=tuple(sections))


def _page_of(read: Inputs) -> Page:
    """Put the page together, without what the files warn of."""
    if read.only_page is not None:
        return read.only_page
    database, run = read.database, read.run
    sections: list[Section] = []
    alarms: list[str] = []
    if database is not None:
        sections += (*static_results(database, nominal_force(read)), *static_making(database))
        alarms += static_alarms(database)
    for study in read.pages.values():
        sections += study.sections
        alarms += study.alarms
    if run is not None:
        sections += (*dynamic_results(run, read.view), *dynamic_making(run))
        alarms += dynamic_alarms(run)
    return Page(_title(read), _lead(read), headlines_of(read), tuple(sections), tuple(alarms))


def headlines_of(read: Inputs) -> tuple[Headline, ...]:
    """Return the main figures of the table, of the studies, and of the run."""
    headlines: list[Headline] = []
    if read.database is not None:
        headlines += static_headlines(read.database, nominal_force(read))
    for study in read.pages.values():
        headlines += study.headlines
    if read.run is not None:
        headlines += dynamic_headlines(read.run)
    return tuple(headlines)


def nominal_force(read: Inputs) -> float | None:
    """Return the normal force in N that the run's load asks of the database's pair; None where it idles."""
    if read.run is None or read.database is None or read.run.nominal_force[0] <= 0.0:
        return None
    return float(read.run.nominal_force[0]) / math.cos(read.database.facts.base_helix_angle)


def _title(read: Inputs) -> str:
    """Name the pair, the one study, or the run."""
    if read.database is not None:
        return pair_title(read.database.facts)
    titles = [page.title for page in read.pages.values()] or ["Dynamics of geared shafts"]
    return titles[0] if len(titles) == 1 else "Studies of gear pairs"


def _lead(read: Inputs) -> str:
    """Say in one line what was computed."""
    parts = []
    if read.database is not None:
        parts.append(pair_lead(read.database.facts))
    elif len(read.pages) == 1:
        parts += [page.lead for page in read.pages.values() if page.lead]
    if read.run is not None:
        parts.append(f"{read.run.time[-1]:.6g} s of motion at {read.run.sample_rate:.6g} samples per second")
    return "; ".join(parts)


# The content of a report as plain JSON: figures as plotly.js takes them, tables, main results.


Json = dict[str, Any]


def stored_figures(inputs: Json) -> Json:
    """Return the report on a stored result: ``{"file": ...}``; work of the live worker."""
    with of_the_store():
        return page_json(page_of(read_inputs([Path(inputs["file"])])))


@contextmanager
def of_the_store() -> Iterator[None]:
    """Turn the refusal of a file into `DamagedFile`: no caller gave it, and none learns where it is."""
    try:
        yield
    except BadInput as error:
        if not any(fault.field == "file" for fault in error.faults):
            raise
        words = "; ".join(f"{fault.bound}. {fault.suggestion}" for fault in error.faults)
        raise DamagedFile(f"The stored file is not {words}") from None


def page_json(page: Page) -> Json:
    """Return a report as plain JSON."""
    return {
        "title": page.title,
        "lead": page.lead,
        "alarms": list(page.alarms),
        "headlines": [{"name": h.name, "value": h.value, "remark": h.remark} for h in page.headlines],
        "sections": [_section(section) for section in page.sections],
    }


def _section(section: Section) -> Json:
    """One part with its figures and tables."""
    return {
        "title": section.title,
        "part": section.part.name.lower(),
        "text": section.text,
        "figures": [_figure(figure) for figure in section.figures],
        "tables": _tables(section.tables),
        "folded": _tables(section.folded),
    }


def _figure(figure: Figure) -> Json:
    """One plot, with what stands in for it where it cannot be seen."""
    return {
        "key": figure.key,
        "title": figure.title,
        "caption": figure.caption,
        "alternative": figure.alternative,
        "plot": plotly_figure(figure),
        "table": None if figure.table is None else _table(figure.table),
        "sound": None if figure.sound is None else sound_json(figure.sound),
    }


def _tables(tables: Iterable[Table]) -> list[Json]:
    return [_table(table) for table in tables]


def _table(table: Table) -> Json:
    return {"caption": table.caption, "head": list(table.head), "rows": [list(row) for row in table.rows]}
