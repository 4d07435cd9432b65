"""Labels at lines, texts beside points, bars of modes: none covers another, and each is where it belongs."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.text import Annotation, Text

from fe_contact.geometry import Gear, GearPair
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Note, Panel, legend_names
from lineofaction.report.drawing.image import panel_sheet, png
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.placing import line_labels, placed, spread_positions
from lineofaction.report.pair import pair_drawing
from lineofaction.report.response.mode_lines import OTHERS, _largest_parts, mode_bars

ENDS = np.array([0.0, 1.0])
HEIGHT = 0.11


def panel(ends: list[float], label: str = "{:g} N m", scale: str = "linear") -> Panel:
    lines = tuple(
        Line(f"{k}", ENDS, np.array([1.0, end]), palette.category(k), label=label.format(10 * k))
        for k, end in enumerate(ends)
    )
    return Panel(Axis("position"), Axis("STE, µm", scale), lines)


def sorted_gaps(middles: np.ndarray, heights: np.ndarray) -> np.ndarray:
    order = np.argsort(middles)
    return np.diff(middles[order]) - 0.5 * (heights[order][1:] + heights[order][:-1])


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_no_label_covers_another_and_all_are_in_the_panel(ends):
    wanted, heights = np.array(ends), np.full(len(ends), HEIGHT)
    middles = spread_positions(wanted, heights)
    assert np.all(sorted_gaps(middles, heights) >= -1e-12)
    assert middles.min() >= 0.5 * HEIGHT - 1e-12 and middles.max() <= 1.0 - 0.5 * HEIGHT + 1e-12
    for (a, b), (low, high) in (
        (pair, (wanted[pair[0]], wanted[pair[1]])) for pair in pairwise(range(len(ends)))
    ):
        assert (middles[a] < middles[b]) == (low < high) or low == high, "they keep the order of their lines"


def test_labels_that_are_apart_stand_at_their_lines():
    wanted = np.array([0.9, 0.2, 0.5])
    np.testing.assert_allclose(spread_positions(wanted, np.full(3, HEIGHT)), wanted)


def test_labels_of_lines_that_end_together_stand_about_their_end():
    middles = spread_positions(np.full(3, 0.5), np.array([0.1, 0.2, 0.1]))
    np.testing.assert_allclose(middles, [0.35, 0.5, 0.65])


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_heights_are_those_of_the_axis(scale):
    drawn = panel([1.0, 10.0, 100.0], scale=scale)
    ends = [label.end for label in line_labels(drawn, 0.01)]
    even = (ends[1] - ends[0]) / (ends[2] - ends[0])
    assert even == pytest.approx(0.5 if scale == "log" else 1.0 / 11.0)


@pytest.mark.parametrize("ends", [[1.0, 1.0, 1.0, 1.0, 1.01], [1.0, 2.0, 3.0, 3.05, 3.1], [5.0]])
def test_drawn_labels_lie_apart_in_both_drawings(ends):
    """Texts of two rows, as the first figure of a report has them."""
    drawn = panel(ends, "{:g} N m: mean 12.3 µm,\n0.84 µm peak to peak")
    sheet = panel_sheet((drawn,))
    canvas = FigureCanvasAgg(sheet)
    canvas.draw()
    texts = [text for text in sheet.axes[0].texts if isinstance(text, Annotation)]
    boxes = sorted((Text.get_window_extent(text) for text in texts), key=lambda box: box.y0)
    assert len(boxes) == len(ends)
    assert all(low.y1 <= high.y0 + 1.0 for low, high in pairwise(boxes))
    assert all(box.x1 <= sheet.bbox.x1 for box in boxes)
    layout = plotly_figure(Figure("key", "Title", "Caption", "Words", (drawn,)))["layout"]
    labels = [note for note in layout["annotations"] if note["showarrow"]]
    height = layout["height"] - layout["margin"]["t"] - layout["margin"]["b"]
    middles = sorted(height * note["y"] - note["ay"] for note in labels)
    assert len(middles) == len(ends)
    assert all(high - low > 30.0 for low, high in pairwise(middles))
    assert layout["margin"]["r"] > 100


def test_labeled_lines_are_not_in_the_legend():
    assert legend_names((panel([1.0, 2.0]),)) == []
    plain = panel([1.0, 2.0], label="")
    assert legend_names((plain,)) == ["0", "1"]


TIME, ERROR = Axis("time, s", "log", (1e-3, 1e5)), Axis("error, %", "log")
RANGE = (0.01, 100.0)


def boxes(notes):
    """Left and right ends and heights of the texts, in parts of the panel, as they are drawn."""
    found = []
    for note in notes:
        across, along = (np.log10(note.x) + 3.0) / 8.0, (np.log10(note.y) + 2.0) / 4.0
        width, height = 0.0072 * len(note.text), along + 0.07 * note.row + (0.0 if note.row >= 0 else -0.05)
        left = across - 0.008 - width if note.left else across + 0.008
        found.append((left, left + width, height))
    return found


@pytest.mark.parametrize("seed", range(5))
def test_no_text_covers_another(seed):
    """Nine points within one decade of time and of error, as the rungs of a ladder lie."""
    random = np.random.default_rng(seed)
    notes = [
        Note(0.5 * 10 ** random.random(), 0.02 * 10 ** random.random(), f"corrected {k}") for k in range(6)
    ]
    found = placed(notes, TIME, ERROR, RANGE)
    assert [note.text for note in found] == [note.text for note in notes]
    ends = boxes(found)
    for i, (left, right, height) in enumerate(ends):
        assert left >= 0.0
        assert right <= 1.0
        for start, end, other in ends[:i]:
            assert end <= left or start >= right or abs(height - other) >= 0.069


def test_a_text_alone_stays_where_it_is():
    notes = (Note(1.0, 1.0, "plane strain"), Note(1e3, 1.0, "3d fine"))
    assert placed(notes, TIME, ERROR, RANGE) == notes


def test_a_text_at_the_top_goes_below_its_point():
    """Above it, it would run into the panel's title."""
    (note,) = placed([Note(1.0, 100.0, "iso6336")], TIME, ERROR, RANGE)
    assert note.row == -1


def test_a_text_at_the_bottom_stays_above_the_axis():
    """Its usual places are taken by its neighbors'."""
    names = ("3d draft 61 (chosen)", "3d standard 61 (knee)", "3d fine (reference)")
    notes = [Note(1.0 + k, 0.01, name) for k, name in enumerate(names)]
    assert min(note.row for note in placed(notes, TIME, ERROR, RANGE)) >= 0


def test_a_text_at_the_right_edge_goes_to_the_left():
    (note,) = placed([Note(9e4, 1.0, "full contact")], TIME, ERROR, RANGE)
    assert note.left


LADDER = {
    "iso6336": (0.0054, 22.5),
    "thin slices": (0.033, 19.6),
    "plane strain (chosen)": (0.56, 2.8),
    "corrected draft (knee)": (0.77, 0.0148),
    "corrected": (0.94, 0.0323),
    "corrected fine": (1.62, 0.0354),
    "3d draft": (1.01, 0.2015),
    "3d draft 61": (2.31, 0.202),
    "3d standard": (2.35, 0.0762),
    "3d standard 61": (3.53, 0.0766),
    "3d fine (reference)": (13.7, 0.0613),
}
"""CPU time in s and error of the mean in % of the rungs of a plane spur pair."""


@pytest.mark.parametrize("slower", [0.8, 1.0, 1.3, 2.0])
def test_the_drawn_texts_of_a_ladder_stand_beside_their_points_and_above_the_axis(slower):
    """Times differ from run to run; here those of three dimensions do."""
    at = {name: (x * (slower if name.startswith("3d") else 1.0), y) for name, (x, y) in LADDER.items()}
    limits = 0.6 * 0.0148, 1.7 * 22.5
    across, along = Axis("time, s", "log", (0.0027, 1.7e5)), Axis("error, %", "log", limits)
    notes = placed([Note(*point, name) for name, point in at.items()], across, along, limits)
    points = np.array(list(at.values())).T
    panel = Panel(across, along, (Line("rungs", *points, "#000000", width=0, markers=True),), notes=notes)
    sheet = panel_sheet((panel, panel))
    FigureCanvasAgg(sheet).draw()
    (axes, _) = sheet.axes
    texts = [text.get_window_extent() for text in axes.texts]
    for i, (text, place) in enumerate(zip(texts, axes.transData.transform(points.T), strict=True)):
        assert text.y0 > axes.get_window_extent().y0
        assert not any(text.overlaps(other) for other in texts[:i])
        middle = 0.5 * (text.y0 + text.y1)
        assert abs(middle - place[1]) < 2.0 * text.height  # in the row above its point or the one below
        assert min(abs(text.x0 - place[0]), abs(text.x1 - place[0])) < 20.0


def test_a_panel_that_ends_below_its_points_keeps_texts_above_the_axis():
    names = ("corrected draft (knee)", "corrected", "corrected fine", "3d standard")
    notes = [Note(1.0 + k, 0.0178, name) for k, name in enumerate(names)]
    ending = Axis("error, %", "log", RANGE)
    assert min(note.row for note in placed(notes, TIME, ending, RANGE)) >= 0
    assert min(note.row for note in placed(notes, TIME, ERROR, RANGE)) == -1


SHARES = [{"input lateral": 0.7, "output torsional": 0.3}, {"output torsional": 0.6}]


def test_the_parts_of_every_mode_add_up_to_the_whole():
    panel = mode_bars(["100 Hz", "200 Hz"], SHARES, "kinetic energy")
    heights = sum(bars.top - bars.base for bars in panel.bars)
    np.testing.assert_allclose(heights, 100.0, rtol=1e-12, atol=0.0)
    for below, above in zip(panel.bars, panel.bars[1:], strict=False):
        np.testing.assert_array_equal(below.top, above.base)
    sizes = {bars.name: (bars.top - bars.base).tolist() for bars in panel.bars}
    assert sizes["output torsional"] == pytest.approx([30.0, 60.0])
    assert sizes[OTHERS] == pytest.approx([0.0, 40.0])


def test_the_largest_parts_have_the_colors():
    many = [{f"part {k}": 0.5 / (k + 2) for k in range(9)}]
    parts = _largest_parts(many)
    assert parts == [f"part {k}" for k in range(len(palette.CATEGORIES))]
    assert [bars.name for bars in mode_bars(["1 Hz"], many, "strain energy").bars][-1] == OTHERS


@pytest.mark.parametrize("teeth", [20, 60])
def test_title_axis_and_legend_of_a_drawing_stand_apart(teeth, monkeypatch):
    sheets: list[Sheet] = []

    def laid_out(sheet, *_, **__):
        sheet.draw_without_rendering()
        sheets.append(sheet)

    monkeypatch.setattr(Sheet, "savefig", laid_out)
    gear = Gear(teeth=teeth, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    png(pair_drawing(GearPair(gear, gear)))
    (sheet,) = sheets
    (title,), (legend,) = sheet.texts, sheet.legends
    first, last = (sheet.axes[index].get_tightbbox() for index in (0, -1))
    assert first is not None and first.y1 <= title.get_window_extent().y0
    assert last is not None and last.y0 >= legend.get_window_extent().y1
