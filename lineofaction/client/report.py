"""The report on a result as a notebook shows it: main results, a picture, effects, accuracy, receipt."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape, unescape
from typing import Any

from service.schemas.report import ReportBody

# A chart of curves as a picture that needs no script.


WIDTH, HEIGHT = 640.0, 260.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 530.0, 10.0, 216.0
"""Edges of the plot; the legend is right of it, the titles and numbers left of it and below."""
_TICKS = 5
_COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")


@dataclass(frozen=True)
class Curve:
    """A curve: its points in order, its name (empty: not in the legend), its color (empty: the next one)."""

    x: Sequence[float]
    y: Sequence[float]
    name: str = ""
    color: str = ""


@dataclass(frozen=True)
class Axis:
    """A linear axis in pixels: `low` is at `start`, `high` at `end`."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return where a value is."""
        return self.start + (value - self.low) / ((self.high - self.low) or 1.0) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Return round values between its ends."""
        span = self.high - self.low
        if span <= 0.0:
            return [self.low]
        power = 10.0 ** math.floor(math.log10(span / _TICKS))
        step = next(step for step in (power, 2.0 * power, 5.0 * power, 10.0 * power) if span / step <= _TICKS)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [round(number * step, 12) for number in range(first, last + 1)]


@dataclass(frozen=True)
class LineChart:
    """Curves over one pair of linear axes.

    Attributes
    ----------
    curves : sequence of Curve
        At least one, each of a point at least.
    across, up : str
        Titles of the axes, with units.
    words : str
        What the picture shows, for those who do not see it.
    """

    curves: Sequence[Curve]
    across: str
    up: str
    words: str

    def svg(self) -> str:
        """Return the picture as SVG."""
        (x, y), named = self._axes(), [curve for curve in self.curves if curve.name]
        colors = [curve.color or _COLORS[at % len(_COLORS)] for at, curve in enumerate(self.curves)]
        parts = [*_grid(x, y), *self._titles()]
        for curve, color in zip(self.curves, colors, strict=True):
            points = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in zip(curve.x, curve.y, strict=True))
            parts.append(
                f'<polyline fill="none" stroke="{escape(color)}" stroke-width="1.5" points="{points}"/>'
            )
        for row, curve in enumerate(named):
            color = colors[self.curves.index(curve)]
            at = f'x="{RIGHT + 8:g}" y="{TOP + 12 + 14 * row:g}"'
            parts.append(f'<text {at} fill="{escape(color)}">{escape(curve.name)}</text>')
        size = f'viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}"'
        look = 'font-family="sans-serif" font-size="12" fill="currentColor" style="max-width:100%"'
        words = escape(self.words, quote=True)
        return f'<svg role="img" aria-label="{words}" {size} {look}>{"".join(parts)}</svg>'

    def _axes(self) -> tuple[Axis, Axis]:
        xs = [value for curve in self.curves for value in curve.x]
        ys = [value for curve in self.curves for value in curve.y]
        return Axis(min(xs), max(xs), LEFT, RIGHT), Axis(min(ys), max(ys), BOTTOM, TOP)

    def _titles(self) -> Iterator[str]:
        middle = (LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0
        yield f'<text x="{middle[0]:g}" y="{HEIGHT - 8:g}" text-anchor="middle">{escape(self.across)}</text>'
        turn = f'transform="translate(14 {middle[1]:g}) rotate(-90)"'
        yield f'<text {turn} text-anchor="middle">{escape(self.up)}</text>'


def _grid(x: Axis, y: Axis) -> Iterator[str]:
    """Yield the ticks of both axes with their lines and numbers."""
    line = 'stroke="currentColor" stroke-opacity="0.15"'
    for value in x.ticks():
        at = f"{x(value):.1f}"
        yield f'<line x1="{at}" x2="{at}" y1="{TOP:g}" y2="{BOTTOM:g}" {line}/>'
        yield f'<text x="{at}" y="{BOTTOM + 15:g}" text-anchor="middle">{value:g}</text>'
    for value in y.ticks():
        at = f"{y(value):.1f}"
        yield f'<line x1="{LEFT:g}" x2="{RIGHT:g}" y1="{at}" y2="{at}" {line}/>'
        yield f'<text x="{LEFT - 5:g}" y="{y(value) + 4:.1f}" text-anchor="end">{value:g}</text>'


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
