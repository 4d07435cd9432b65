"""The report on a result as a notebook shows it: main results, a picture, effects, accuracy, receipt."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape
from typing import Any

from service.schemas.report import ReportBody

_WIDTH, _HEIGHT, _MARGIN = 640.0, 220.0, 10.0
_COLORS = ("#0b62a4", "#b5500a", "#2d7d46", "#7a3e9d", "#8a6d00", "#555555")

Json = dict[str, Any]
Curve = tuple[list[float], list[float]]


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

    def _picture(self) -> Iterator[str]:
        """Yield the first figure that has curves."""
        for figure in (figure for section in self.sections for figure in section["figures"]):
            curves = list(_curves(figure["plot"]["data"]))
            if curves:
                words = escape(figure["alternative"], quote=True)
                caption = f"<figcaption>{escape(figure['title'])}</figcaption>"
                yield f"<figure>{_drawing(curves, words)}{caption}</figure>"
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


def _curves(traces: Iterable[Json]) -> Iterator[Curve]:
    """Yield what is drawn as a line on the first pair of axes."""
    for trace in traces:
        drawn = trace["type"] == "scatter" and trace.get("mode") == "lines" and trace["line"].get("width", 1)
        points = [
            (float(x), float(y))
            for x, y in zip(trace.get("x", ()), trace.get("y", ()), strict=False)
            if x is not None and y is not None
        ]
        if drawn and trace.get("yaxis", "y") == "y" and len(points) > 1:
            yield [x for x, _ in points], [y for _, y in points]


def _drawing(curves: list[Curve], words: str) -> str:
    """Return curves as a picture that needs no script."""
    left, right = (edge(edge(xs) for xs, _ in curves) for edge in (min, max))
    low, high = (edge(edge(ys) for _, ys in curves) for edge in (min, max))
    across = (_WIDTH - 2.0 * _MARGIN) / ((right - left) or 1.0)
    up = (_HEIGHT - 2.0 * _MARGIN) / ((high - low) or 1.0)
    lines = []
    for number, (xs, ys) in enumerate(curves):
        points = " ".join(
            f"{_MARGIN + (x - left) * across:.1f},{_HEIGHT - _MARGIN - (y - low) * up:.1f}"
            for x, y in zip(xs, ys, strict=True)
        )
        color = _COLORS[number % len(_COLORS)]
        lines.append(f'<polyline fill="none" stroke="{color}" stroke-width="1.5" points="{points}"/>')
    size = f'viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" width="{_WIDTH:g}"'
    return f'<svg role="img" aria-label="{words}" {size}>{"".join(lines)}</svg>'
