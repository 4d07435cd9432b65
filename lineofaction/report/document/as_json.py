"""The content of a report as plain JSON: figures as plotly.js takes them, tables, main results.

It is what the page of the service shows, so that every plot is described once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput, DamagedFile
from lineofaction.report.document.content import page_of
from lineofaction.report.document.inputs import read_inputs
from lineofaction.report.drawing.figure import Figure, Table
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.page import Page, Section
from lineofaction.report.drawing.player import sound_json

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
