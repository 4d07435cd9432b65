"""The report on a result as a notebook shows it: main results, effects, accuracy, receipt."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import Any

from service.schemas.answers import ReportBody

Json = dict[str, Any]


class Report(ReportBody):
    """A report on a result. In a notebook it shows itself; its figures are for plotly.js."""

    def _repr_html_(self) -> str:
        """Return title, main results, and the tables of all sections, folded."""
        return "".join(
            (
                f"<h3>{escape(self.title)}</h3><p>{escape(self.lead)}</p>",
                *(f"<p><strong>{escape(alarm)}</strong></p>" for alarm in self.alarms),
                _table([], ([h["name"], h["value"], h["remark"]] for h in self.headlines)),
                *map(_section, self.sections),
            )
        )

    def __repr__(self) -> str:
        """Return title and main results; the sections are long."""
        results = "; ".join(f"{h['name']} {h['value']} {h['remark']}".strip() for h in self.headlines)
        return f"<{type(self).__name__} {self.title}: {results}>"


def _section(section: Json) -> str:
    tables = [*section["tables"], *section["folded"]]
    rows = "".join(_table(table["head"], table["rows"]) for table in tables if table["rows"])
    return f"<details><summary>{escape(section['title'])}</summary>{rows}</details>" if rows else ""


def _table(head: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    top = "".join(f"<th>{escape(str(cell))}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(f'<td>{escape(str(cell))}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><tr>{top}</tr>{body}</table>"
