"""Names in plots are shown as they are; what has no place on an axis is left out."""

from __future__ import annotations

import json
from collections.abc import Iterator
from html import escape, unescape
from typing import Any

import numpy as np
import pytest
from extreme_inputs import NAMES
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cbook import is_math_text
from matplotlib.text import Text

from lineofaction.client.report import Report
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, HeatMap, Line, Note, Panel, Reference
from lineofaction.report.drawing.image import _drawable, _panel_sheet, png
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.placing import rewritten

X = np.linspace(0.0, 2.0, 5)


def named(name: str) -> Figure:
    lines = (Line(name, X, X, palette.BLUE), Line("other", X, 2.0 * X, palette.GREEN, label=name))
    bars = (Bars(f"{name} bar", X, X, 0.0, 0.1, palette.SKY),)
    names = ((0.0, name), (1.0, "one"))
    curves = Panel(
        Axis(name), Axis(name), lines, (Reference(name, 1.0),), name, notes=(Note(1.0, 1.0, name),), bars=bars
    )
    shade = HeatMap(X, X, np.outer(X, X), f"{name}, N", 4.0)
    return Figure("key", name, name, name, (curves, Panel(Axis("x"), Axis("y", names=names), shade=shade)))


def texts(plot: Any, key: str = "") -> Iterator[str]:
    if isinstance(plot, dict):
        for name, value in plot.items():
            yield from texts(value, name)
    elif isinstance(plot, list):
        for value in plot:
            yield from texts(value, key)
    elif isinstance(plot, str) and key in ("text", "name", "ticktext", "hovertemplate", "label"):
        yield plot


@pytest.mark.drawn
@pytest.mark.parametrize("name", NAMES)
def test_an_image_holds_every_name_and_no_formula(name: str) -> None:
    assert png(named(name)).startswith(b"\x89PNG")
    sheet = _panel_sheet(rewritten(named(name).content, _drawable))
    FigureCanvasAgg(sheet).draw()
    drawn = [text.get_text() for text in sheet.findobj(Text)]
    assert not any(map(is_math_text, drawn))
    written = _drawable(name)
    assert sum(written in text for text in drawn) >= 7
    assert (
        written.replace(r"\$", "$") == name or not name.isprintable() or not name.isascii() or len(name) > 25
    )


@pytest.mark.parametrize("name", NAMES)
def test_plotly_shows_every_name_and_takes_none_for_markup(name: str) -> None:
    plot = plotly_figure(named(name))
    found = list(texts(plot))
    shown = [text for text in found if unescape(text).replace("<br>", "\n").count(name)]
    assert len(shown) >= 8
    for text in found:
        tags = (
            text.replace("<b>", "", 1)
            .replace("</b>", "", 1)
            .replace("<br>", "")
            .replace("<extra></extra>", "")
        )
        assert "<" not in tags or "%{" in text
    assert not name.strip() or not any(
        escape(name) in text for text in found if "<extra>" in text and "%{x}: " in text
    )
    assert json.dumps(plot, allow_nan=False)


def test_a_notebook_and_a_legend_have_the_name_itself() -> None:
    name = "<b>&amp;</b>"
    figure = {"title": "t", "alternative": "a", "plot": plotly_figure(named(name)), "key": "k"}
    words = {"head": [name], "rows": [[name]]}
    section = {"title": name, "figures": [figure], "tables": [words], "folded": []}
    page = Report.model_validate(
        {"title": "t", "lead": "", "alarms": [], "headlines": [], "sections": [section]}
    )._repr_html_()
    assert escape(name) in page
    assert escape(escape(name)) not in page


@pytest.mark.parametrize("ends", [(0.0, 0.0), (np.nan, 1.0), (-1.0, np.inf), (3.0, 1.0)])
@pytest.mark.parametrize("scale", ["linear", "log"])
def test_limits_between_which_nothing_lies_are_left_to_the_data(
    ends: tuple[float, float], scale: Any
) -> None:
    line = Line("zero", X, np.zeros(X.size), palette.BLUE, label="zero")
    marks = (Reference("nowhere", np.nan, "horizontal"), Reference("left", np.inf), Reference("zero", 0.0))
    notes = (Note(1.0, np.nan, "nowhere"), Note(1.0, 0.0, "zero"))
    panel = Panel(Axis("x"), Axis("y", scale, ends), (line,), marks, notes=notes)
    figure = Figure("key", "t", "c", "w", (panel,))
    plot = plotly_figure(figure)
    assert json.dumps(plot, allow_nan=False)
    told = [one["text"] for one in plot["layout"]["annotations"]]
    assert "nowhere" not in told and "left" not in told
    assert png(figure).startswith(b"\x89PNG")
