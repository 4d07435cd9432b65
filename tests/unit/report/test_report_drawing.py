"""Both ways of drawing one figure description agree with it; names are shown as they are."""

import json
import struct
from collections.abc import Iterator
from dataclasses import replace
from html import escape, unescape
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from extreme_inputs import NAMES
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cbook import is_math_text
from matplotlib.text import Text

from lineofaction.client.report import Report
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    HeatMap,
    Line,
    Note,
    Panel,
    Reference,
    Strokes,
    legend_names,
    number,
)
from lineofaction.report.drawing.image import drawable, panel_sheet, png
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.placing import rewritten

X = np.linspace(0.0, 2.0, 9)


def stacked(count: int = 2) -> Figure:
    y = np.sin(np.pi * X)
    y[3] = np.nan
    lines = (Line("a", X, y, palette.BLUE), Line("b", X, 2 * X, palette.GREEN, "dash"))
    references = (Reference("first", 1.0), Reference("level", 0.5, "horizontal"))
    panel = Panel(Axis("position, base pitches"), Axis("STE, µm"), lines, references, "100 N m")
    return Figure("key", "Title", "Caption", "Words", (panel,) * count)


def test_every_line_of_every_panel_is_drawn_with_its_data():
    drawn = plotly_figure(stacked())
    assert len(drawn["data"]) == 4
    assert drawn["data"][3]["y"] == pytest.approx(list(2 * X))
    assert drawn["data"][0]["y"][3] is None


def test_a_name_stands_once_in_the_legend():
    shown = [trace["name"] for trace in plotly_figure(stacked())["data"] if trace["showlegend"]]
    assert shown == ["a", "b"]


def test_a_line_that_a_note_names_is_not_in_the_legend():
    (panel,) = stacked(1).content
    noted = replace(stacked(), content=(panel, replace(panel, notes=(Note(2.0, 4.0, "b"),))))
    assert legend_names(noted.content) == ["a", "b"]  # the first panel needs it
    alone = replace(noted, content=(noted.content[1],))
    assert [t["name"] for t in plotly_figure(alone)["data"] if t["showlegend"]] == ["a"]
    assert not plotly_figure(alone)["layout"]["showlegend"]


def test_an_error_band_lies_about_its_line_in_both_drawings():
    line = Line("a", X, X**2, palette.BLUE, band=0.5)
    panel = Panel(Axis("x"), Axis("y"), (line, replace(line, name="b", band=float("nan"))))
    low, high, drawn, _ = plotly_figure(Figure("key", "t", "c", "w", (panel,)))["data"]
    np.testing.assert_allclose(np.array(high["y"]) - np.array(drawn["y"]), 0.5)
    np.testing.assert_allclose(np.array(drawn["y"]) - np.array(low["y"]), 0.5)
    assert high["fill"] == "tonexty"
    (shade,) = panel_sheet((panel,)).axes[0].collections
    corners = shade.get_paths()[0].vertices
    assert corners[:, 1].min() == pytest.approx(-0.5)
    assert corners[:, 1].max() == pytest.approx(4.5)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_panels_share_the_height_without_overlap(count):
    layout = plotly_figure(stacked(count))["layout"]
    domains = [layout["yaxis" + (str(i + 1) if i else "")]["domain"] for i in range(count)]
    assert domains[0][1] == 1.0
    assert domains[-1][0] == pytest.approx(0.0, abs=1e-6)
    for upper, lower in pairwise(domains):
        assert upper[0] > lower[1]


@pytest.mark.parametrize(("length", "rows"), [(5, 1), (40, 2), (80, 3)])
def test_long_names_get_the_rows_of_the_legend_they_need(length, rows):
    lines = tuple(Line(f"{i}".ljust(length, "n"), X, X, palette.BLUE) for i in range(4))
    panel = Panel(Axis("x"), Axis("y"), lines, title="a")
    above = plotly_figure(replace(stacked(), content=(panel,)))["layout"]["margin"]["t"]
    assert above == 62 + 22 * (rows - 1)


def test_references_fake_their_own_panel():
    shapes = plotly_figure(stacked())["layout"]["shapes"]
    assert [(s["xref"], s["yref"]) for s in shapes] == [
        ("x", "y domain"), ("x domain", "y"), ("x2", "y2 domain"), ("x2 domain", "y2"),
    ]  # fmt: skip
    assert shapes[0]["x0"] == shapes[0]["x1"] == 1.0
    assert shapes[1]["y0"] == shapes[1]["y1"] == 0.5


def test_a_logarithmic_axis_places_limits_and_labels_in_decades():
    panel = stacked(1).content[0]
    panel = replace(
        panel, x=Axis("frequency, Hz", "log", (10.0, 1000.0)), references=(Reference("f", 100.0),)
    )
    layout = plotly_figure(replace(stacked(), content=(panel,)))["layout"]
    assert layout["xaxis"]["range"] == [1.0, 3.0]
    note = next(a for a in layout["annotations"] if a["text"] == "f")
    assert note["x"] == 2.0


@pytest.mark.parametrize("count", [1, 3])
def test_an_image_grows_with_its_panels(count):
    image = png(stacked(count))
    assert image.startswith(b"\x89PNG")
    width, height = struct.unpack(">II", image[16:24])
    assert width == 1350
    assert height == pytest.approx(150 * (1.7 * count + 0.9), abs=1)


def _ticks(x: list[float], y: list[float]) -> tuple[list[str], list[str]]:
    """Labels within the limits of an image with these points, logarithmic in y."""
    line = Line("a", np.array(x), np.array(y), palette.BLUE)
    sheet = panel_sheet((Panel(Axis("mesh order"), Axis("amplitude", "log"), (line,)),))
    FigureCanvasAgg(sheet).draw()
    (ax,) = sheet.axes
    found = []
    for axis in (ax.xaxis, ax.yaxis):
        low, high = axis.get_view_interval()
        ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
        found.append([t.label1.get_text() for t in ticks if low <= t.get_loc() <= high])
    return tuple([text for text in texts if text] for texts in found)


def test_orders_have_ticks_at_whole_numbers_and_fractions_have_their_own():
    assert _ticks([1.0, 2.0, 3.0, 4.0, 5.0], [1.0] * 5)[0] == ["1", "2", "3", "4", "5"]
    assert "1.50" in _ticks([1.0, 1.5, 2.0, 3.0], [1.0] * 4)[0]


def test_a_narrow_logarithmic_axis_has_plain_numbers():
    assert _ticks([1.0, 2.0], [0.6, 7.0])[1] == ["1", "2", "5"]
    assert all("10^" in text for text in _ticks([1.0, 2.0], [1e-4, 1e3])[1])


@pytest.mark.parametrize("length", [5, 34, 200])
@pytest.mark.parametrize("count", [2, 4, 5, 7])
def test_a_legend_stays_within_the_sheet(count, length):
    """Its right end, as drawn; a name that alone is wider than the sheet stands in a column of its own."""
    x = np.linspace(0.0, 1.0, 3)
    lines = tuple(Line(f"{i}".ljust(length, "n"), x, x, palette.BLUE) for i in range(count))
    sheet = panel_sheet((Panel(Axis("x"), Axis("y"), lines),))
    canvas = FigureCanvasAgg(sheet)
    canvas.draw()
    (legend,) = sheet.legends
    assert len(legend.get_texts()) == count
    if length < 100:
        assert legend.get_window_extent().x1 <= sheet.bbox.x1
    else:
        assert legend._ncols == 1


def test_ordered_colors_lighten_and_stay_visible_on_white():
    def luminance(color):
        parts = (int(color[i : i + 2], 16) / 255 for i in (1, 3, 5))
        linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    values = [luminance(palette.ordered(i, 12)) for i in range(12)]
    assert values == sorted(values)
    assert 1.05 / (values[-1] + 0.05) > 1.7  # contrast ratio to white of the lightest


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(6.24531, 4, "6.245"), (0.0001234, 3, "0.000123"), (2660.4, 5, "2660.4"), (1.2e-9, 2, "1.2e-9"),
     (0.0, 4, "0"), (float("nan"), 4, "none"), (123456.0, 3, "123456")],
)  # fmt: skip
def test_numbers_have_their_significant_digits(value, digits, text):
    assert number(value, digits) == text


def shaded(shade: HeatMap | Strokes, count: int = 2) -> Figure:
    panel = Panel(Axis("face, mm"), Axis("roll length, mm"), shade=shade, title="pinion")
    return Figure("key", "Title", "Caption", "Words", (panel,) * count)


def test_cells_keep_their_places_and_blanks():
    z = np.array([[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]])
    drawn = plotly_figure(shaded(HeatMap(np.arange(3.0), np.arange(2.0), z, "pressure, MPa", 6.0)))
    upper, lower = drawn["data"]
    assert upper["z"] == [[1.0, None, 3.0], [4.0, 5.0, 6.0]]
    assert (upper["zmin"], upper["zmax"]) == (0.0, 6.0)
    assert (upper["xaxis"], lower["xaxis"]) == ("x", "x2")
    domain = drawn["layout"]["yaxis2"]["domain"]
    assert lower["colorbar"]["y"] == pytest.approx(0.5 * sum(domain))
    assert lower["colorbar"]["len"] == pytest.approx(domain[1] - domain[0])
    assert "MPa" in upper["hovertemplate"]


def test_names_stand_on_an_axis_in_place_of_numbers():
    line = Line("torque", np.array([0.0, 2.0]), np.array([1.0, 1.0]), "#000000")
    panel = Panel(Axis("N"), Axis("", limits=(0.4, 2.6), names=((1.0, "torque"), (2.0, "speed"))), (line,))
    figure = Figure("key", "Title", "Caption", "Words", (panel,))
    assert legend_names(figure.content) == []
    axis = plotly_figure(figure)["layout"]["yaxis"]
    assert (axis["tickvals"], axis["ticktext"]) == ([1.0, 2.0], ["torque", "speed"])
    drawn = panel_sheet(figure.content).axes[0]
    assert [tick.get_text() for tick in drawn.get_yticklabels()] == ["torque", "speed"]


def test_colors_span_least_to_largest():
    shade = HeatMap(
        np.arange(3.0), np.arange(2.0), 1.0 + 0.01 * np.arange(6.0).reshape(2, 3), "K_v, ratio", 1.05, 1.0
    )
    drawn = plotly_figure(shaded(shade, 1))["data"][0]
    assert (drawn["zmin"], drawn["zmax"]) == (1.0, 1.05)
    _, scale = panel_sheet(shaded(shade, 1).content).axes
    assert scale.get_ylim() == (1.0, 1.05)


def test_every_stroke_is_drawn_once_wider_with_its_value():
    value = np.array([0.0, 1.0, 50.0, 100.0, 0.0])
    x = np.stack([np.arange(5.0), np.arange(5.0) + 0.5], axis=1)
    drawn = plotly_figure(shaded(Strokes(x, -x, value, "line load, N/mm", 100.0), 1))["data"]
    curves = [trace for trace in drawn if trace["mode"] == "lines"]
    starts = {trace["x"][i]: trace["line"]["width"] for trace in curves for i in range(0, len(trace["x"]), 3)}
    assert sorted(starts) == [0.0, 1.0, 2.0, 3.0, 4.0]
    widths = [starts[k] for k in (0.0, 1.0, 2.0, 3.0)]
    assert widths == sorted(widths) and widths[0] == starts[4.0]
    assert len({widths[1], widths[2], widths[3]}) == 3
    assert all(trace["x"][2::3] == [None] * (len(trace["x"]) // 3) for trace in curves)
    (scale,) = [trace for trace in drawn if trace["mode"] == "markers"]
    assert scale["marker"]["cmax"] == 100.0
    assert "100.0 N/mm" in [word for trace in curves for word in trace["text"]]


def test_a_sheet_of_cells_or_strokes_shows_its_scale():
    x = np.stack([np.arange(3.0), np.arange(3.0) + 0.5], axis=1)
    for shade in (
        HeatMap(np.arange(3.0), np.arange(2.0), np.ones((2, 3)), "pressure, MPa", 2.0),
        Strokes(x, x, np.array([0.0, 1.0, 2.0]), "line load, N/mm", 2.0),
    ):
        sheet = panel_sheet(shaded(shade, 1).content)
        panel, scale = sheet.axes
        assert scale.get_ylabel() == shade.label
        assert scale.get_ylim() == (0.0, 2.0)
        assert len(panel.collections) >= 1


FEW = np.linspace(0.0, 2.0, 5)


def named(name: str) -> Figure:
    lines = (Line(name, FEW, FEW, palette.BLUE), Line("other", FEW, 2.0 * FEW, palette.GREEN, label=name))
    bars = (Bars(f"{name} bar", FEW, FEW, 0.0, 0.1, palette.SKY),)
    names = ((0.0, name), (1.0, "one"))
    curves = Panel(
        Axis(name), Axis(name), lines, (Reference(name, 1.0),), name, notes=(Note(1.0, 1.0, name),), bars=bars
    )
    shade = HeatMap(FEW, FEW, np.outer(FEW, FEW), f"{name}, N", 4.0)
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
def test_an_image_holds_every_name_and_no_formula(name):
    assert png(named(name)).startswith(b"\x89PNG")
    sheet = panel_sheet(rewritten(named(name).content, drawable))
    FigureCanvasAgg(sheet).draw()
    drawn = [text.get_text() for text in sheet.findobj(Text)]
    assert not any(map(is_math_text, drawn))
    written = drawable(name)
    assert sum(written in text for text in drawn) >= 7
    assert (
        written.replace(r"\$", "$") == name or not name.isprintable() or not name.isascii() or len(name) > 25
    )


@pytest.mark.parametrize("name", NAMES)
def test_plotly_shows_every_name_and_takes_none_for_markup(name):
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


def test_a_notebook_and_a_legend_have_the_name_itself():
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
def test_limits_between_which_nothing_lies_are_left_to_the_data(ends, scale):
    line = Line("zero", FEW, np.zeros(FEW.size), palette.BLUE, label="zero")
    marks = (Reference("nowhere", np.nan, "horizontal"), Reference("left", np.inf), Reference("zero", 0.0))
    notes = (Note(1.0, np.nan, "nowhere"), Note(1.0, 0.0, "zero"))
    panel = Panel(Axis("x"), Axis("y", scale, ends), (line,), marks, notes=notes)
    figure = Figure("key", "t", "c", "w", (panel,))
    plot = plotly_figure(figure)
    assert json.dumps(plot, allow_nan=False)
    told = [one["text"] for one in plot["layout"]["annotations"]]
    assert "nowhere" not in told and "left" not in told
    assert png(figure).startswith(b"\x89PNG")
