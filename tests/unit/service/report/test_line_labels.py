"""Labels at the ends of lines: none covers another, and each stands as near to its line as it can."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Annotation, Text

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, legend_names
from lineofaction.report.drawing.image import _panel_sheet
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.placing import _spread, line_labels

X = np.array([0.0, 1.0])
HEIGHT = 0.11


def panel(ends: list[float], label: str = "{:g} N m", scale: str = "linear") -> Panel:
    lines = tuple(
        Line(f"{k}", X, np.array([1.0, end]), palette.category(k), label=label.format(10 * k))
        for k, end in enumerate(ends)
    )
    return Panel(Axis("position"), Axis("STE, µm", scale), lines)  # type: ignore[arg-type]


def sorted_gaps(middles: np.ndarray, heights: np.ndarray) -> np.ndarray:
    order = np.argsort(middles)
    return np.diff(middles[order]) - 0.5 * (heights[order][1:] + heights[order][:-1])


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_no_label_covers_another_and_all_are_in_the_panel(ends: list[float]) -> None:
    wanted, heights = np.array(ends), np.full(len(ends), HEIGHT)
    middles = _spread(wanted, heights)
    assert np.all(sorted_gaps(middles, heights) >= -1e-12)
    assert middles.min() >= 0.5 * HEIGHT - 1e-12 and middles.max() <= 1.0 - 0.5 * HEIGHT + 1e-12
    for (a, b), (low, high) in (
        (pair, (wanted[pair[0]], wanted[pair[1]])) for pair in pairwise(range(len(ends)))
    ):
        assert (middles[a] < middles[b]) == (low < high) or low == high, "they keep the order of their lines"


def test_labels_that_are_apart_stand_at_their_lines() -> None:
    wanted = np.array([0.9, 0.2, 0.5])
    np.testing.assert_allclose(_spread(wanted, np.full(3, HEIGHT)), wanted)


def test_labels_of_lines_that_end_together_stand_about_their_end() -> None:
    middles = _spread(np.full(3, 0.5), np.array([0.1, 0.2, 0.1]))
    np.testing.assert_allclose(middles, [0.35, 0.5, 0.65])


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_heights_are_those_of_the_axis(scale: str) -> None:
    drawn = panel([1.0, 10.0, 100.0], scale=scale)
    ends = [label.end for label in line_labels(drawn, 0.01)]
    even = (ends[1] - ends[0]) / (ends[2] - ends[0])
    assert even == pytest.approx(0.5 if scale == "log" else 1.0 / 11.0)


@pytest.mark.parametrize("ends", [[1.0, 1.0, 1.0, 1.0, 1.01], [1.0, 2.0, 3.0, 3.05, 3.1], [5.0]])
def test_drawn_labels_lie_apart_in_both_drawings(ends: list[float]) -> None:
    """Texts of two rows, as the first figure of a report has them."""
    drawn = panel(ends, "{:g} N m: mean 12.3 µm,\n0.84 µm peak to peak")
    sheet = _panel_sheet((drawn,))
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


def test_labeled_lines_are_not_in_the_legend() -> None:
    assert legend_names((panel([1.0, 2.0]),)) == []
    plain = panel([1.0, 2.0], label="")
    assert legend_names((plain,)) == ["0", "1"]
