"""The report on a result as a notebook shows it: main results, a picture, effects, accuracy, receipt."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape, unescape
from typing import Any

from lineofaction.client.line_chart import Curve, LineChart
from service.schemas.report import ReportBody

Json = dict[str, Any]


class Report(ReportBody):
    """A report on a result. In a notebook it shows itself; its figures are for plotly.js."""

    def _repr_html_(self) -> str:
        """Return title, main results, the first picture, and the tables of all sections, folded."""
        return "".join(
            (
                f"<h3>{escape(self.title)}</h3><p>{escape(self.lead)}</p>",
                *(f"<p><strong>{escape(alarm)}</strong></p>" for alarm in self.alarms),
                _table([], ([h["name"], h["value"], h["remark"]] for h in self.headlines)),
                *self._picture(),
                *map(_section, self.sections),
            )
        )

    def __repr__(self) -> str:
        """Return title and main results; the sections are long."""
        results = "; ".join(f"{h['name']} {h['value']} {h['remark']}".strip() for h in self.headlines)
        return f"<{type(self).__name__} {self.title}: {results}>"

    def _picture(self) -> Iterator[str]:
        """Yield the first figure that has curves over a quantity."""
        for figure in (figure for section in self.sections for figure in section["figures"]):
            chart = _chart(figure)
            if chart is not None:
                yield f"<figure>{chart.svg()}<figcaption>{escape(figure['title'])}</figcaption></figure>"
                return


def _section(section: Json) -> str:
    """Return the tables of a section; nothing of one without."""
    tables = [*section["tables"], *section["folded"]]
    rows = "".join(_table(table["head"], table["rows"]) for table in tables if table["rows"])
    return f"<details><summary>{escape(section['title'])}</summary>{rows}</details>" if rows else ""


def _table(head: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Return a table."""
    top = "".join(f"<th>{escape(str(cell))}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(f'<td>{escape(str(cell))}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><tr>{top}</tr>{body}</table>"


def _chart(figure: Json) -> LineChart | None:
    """Return the curves over the first pair of axes; None of a drawing, whose axes have one scale."""
    layout, curves = figure["plot"]["layout"], list(_curves(figure["plot"]["data"]))
    axes = [layout[name] for name in ("xaxis", "yaxis")]
    if not curves or any("scaleanchor" in axis or axis.get("type") != "linear" for axis in axes):
        return None
    across, up = ([_title(layout[name]) for name in layout if name.startswith(f"{of}axis")] for of in "xy")
    titled = [title for title in across if title]  # stacked axes have it below the last one
    return LineChart(curves, titled[0] if titled else "", up[0], figure["alternative"])


def _title(axis: Json) -> str:
    """Return the title of an axis, whose text is HTML to plotly.js."""
    return unescape((axis.get("title") or {}).get("text") or "")


def _curves(traces: Iterable[Json]) -> Iterator[Curve]:
    """Yield what is drawn as a line on the first pair of axes; beside others a curve has a name."""
    for trace in traces:
        drawn = (
            trace["type"] == "scatter" and "lines" in trace.get("mode", "") and trace["line"].get("width", 1)
        )
        points = [
            (float(x), float(y))
            for x, y in zip(trace.get("x", ()), trace.get("y", ()), strict=False)
            if x is not None and y is not None
        ]
        if drawn and trace.get("yaxis", "y") == "y" and len(points) > 1:
            x, y = zip(*points, strict=True)
            yield Curve(x, y, unescape(trace.get("name") or ""), trace["line"].get("color") or "")
