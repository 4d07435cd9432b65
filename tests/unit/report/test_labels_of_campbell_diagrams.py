"""Campbell diagrams of close modes and many orders: every text is read, none lies over another."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Annotation, Text

from dynamics.results import RunResult
from lineofaction.report.drawing.figure import Axis, Figure, Panel, half_figures
from lineofaction.report.drawing.image import panel_sheet
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.placing import named_along
from lineofaction.report.run.levels import campbell, frequency_blocks
from lineofaction.report.run.view import RunView, selected_signal

MOVES = [f"{shaft}, {kind}" for shaft in ("intermediate", "output") for kind in ("torsional", "lateral")]
CLOSE = [700.0 + 25.0 * k for k in range(8)]
"""Frequencies of eight modes within 200 Hz."""
CHARACTER, ROW, WIDTH = 6.6, 15.0, 700.0
"""Width of a character and height of a text of 12 pixels on a page, and width of its panel, pixels."""


class Box(NamedTuple):
    text: str
    left: float
    right: float
    low: float
    high: float


def overlapping(boxes: Sequence[Box]) -> list[tuple[str, str]]:
    """Return the pairs of texts that share more than a pixel in both directions."""
    return [
        (one.text, other.text)
        for one, other in combinations(boxes, 2)
        if min(one.right, other.right) - max(one.left, other.left) > 1.0
        and min(one.high, other.high) - max(one.low, other.low) > 1.0
    ]


def drawn_boxes(panel: Panel) -> tuple[list[Box], Box]:
    """Return the boxes of the texts in the image of a panel, and that of the panel."""
    sheet = panel_sheet((panel,))
    FigureCanvasAgg(sheet).draw()
    axes = sheet.axes[0]
    boxes = []
    for text in axes.texts:
        assert isinstance(text, Annotation)
        patch = text.get_bbox_patch()
        found = Text.get_window_extent(text) if patch is None else patch.get_window_extent()
        boxes.append(Box(text.get_text(), found.x0, found.x1, found.y0, found.y1))
    frame = axes.get_window_extent()
    return boxes, Box("panel", frame.x0, frame.x1, frame.y0, frame.y1)


def page_boxes(panel: Panel) -> tuple[list[Box], Box]:
    """Return the boxes of the texts in the plot on a page, in pixels from its lower left corner."""
    layout = plotly_figure(Figure("key", "Title", "Caption", "Words", (panel,)))["layout"]
    height = layout["height"] - layout["margin"]["t"] - layout["margin"]["b"]
    (x0, x1), (y0, y1) = (layout[axis]["range"] for axis in ("xaxis", "yaxis"))
    boxes = []
    for note in layout["annotations"]:
        leads = note["showarrow"]
        x, y = (note["ax"], note["ay"]) if leads else (note["x"], note["y"])
        at = WIDTH * (x - x0) / (x1 - x0) + note.get("xshift", 0)
        low = height * (y - y0) / (y1 - y0) + note.get("yshift", 0)
        low -= {"bottom": 0.0, "middle": 0.5 * ROW}[note["yanchor"]]
        width = CHARACTER * len(note["text"])
        left = at - (width if note["xanchor"] == "right" else 0.0)
        boxes.append(Box(note["text"], left, left + width, low, low + ROW))
    return boxes, Box("panel", 0.0, WIDTH, 0.0, height)


def panel_of(run: RunResult, frequencies: Sequence[float]) -> Panel:
    count = len(frequencies)
    moves = [{MOVES[k % len(MOVES)]: 1.0} for k in range(count)]
    modes = {"frequency": [*frequencies], "damping_ratio": [0.05] * count, "freedom": ["input.y"] * count}
    signal = selected_signal(run, RunView())
    shown = replace(run, modes=modes | {"moves": moves})
    (panel,) = campbell(shown, signal, frequency_blocks(shown, signal)).content
    return panel


def assert_read(boxes: list[Box], frame: Box, texts: set[str]) -> None:
    assert {box.text for box in boxes} == texts
    assert overlapping(boxes) == []
    for box in boxes:
        assert box.left >= frame.left - 1.0 and box.right <= frame.right + 1.0, box
        assert box.low >= frame.low - 1.0 and box.high <= frame.high + 0.05 * (frame.high - frame.low), box


@pytest.mark.parametrize("boxes_of", [drawn_boxes, page_boxes])
@pytest.mark.parametrize("first", [25.0, 700.0, 1700.0])
def test_no_label_of_eight_close_modes_lies_over_another(run, boxes_of, first):
    """Modes at the foot, in the middle and at the top of the diagram; the orders keep their names, too."""
    panel = panel_of(run, [first - CLOSE[0] + hertz for hertz in CLOSE])
    boxes, frame = boxes_of(panel)
    assert len(panel.notes) == 8 + 8
    assert_read(boxes, frame, {note.text for note in panel.notes})
    labels = [note for note in panel.notes if note.tail is not None]
    heights = [note.tail[1] for note in labels if note.tail]
    assert heights == sorted(heights) and [note.y for note in labels] == sorted(note.y for note in labels)


def test_a_mode_that_stands_alone_has_its_label_at_its_line(run):
    panel = panel_of(run, [300.0, 900.0])
    labels = [note for note in panel.notes if note.tail is not None]
    assert [note.tail[1] for note in labels if note.tail] == pytest.approx([300.0, 900.0])
    assert [note.color for note in labels] == [
        line.color for line in panel.lines if line.name == "natural modes"
    ]


def test_labels_with_leaders_need_the_width_of_the_page(run):
    figure = Figure("key", "Title", "Caption", "Words", (panel_of(run, [300.0]),))
    assert half_figures([figure]) == set()


@pytest.mark.parametrize("boxes_of", [drawn_boxes, page_boxes])
@pytest.mark.parametrize("rates", [(1.0, 1.0), (1.0, 1.02), (1.0, 0.9, 0.35)])
def test_names_of_orders_of_several_meshes_lie_apart(boxes_of, rates):
    """Orders of meshes with nearly one frequency end at nearly one place."""
    x, y = Axis("speed, rpm", limits=(0.0, 3000.0)), Axis("frequency, Hz", limits=(0.0, 5000.0))
    curves: list[Any] = []
    for mesh, rate in enumerate(rates):
        for order in range(1, 6):
            end = min(3000.0, 0.97 * 5000.0 / (order * rate))
            speed = np.linspace(end, 0.0, 40)
            curves.append((f"{order}x stage {mesh}", speed, order * rate * speed))
    names = named_along(curves, x, y)
    boxes, frame = boxes_of(Panel(x, y, notes=names))
    assert_read(boxes, frame, {name for name, _, _ in curves})
