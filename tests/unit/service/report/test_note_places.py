"""Texts beside points: none covers another, wherever the points lie."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from lineofaction.report.drawing.figure import Axis, Line, Note, Panel
from lineofaction.report.drawing.image import _panel_sheet
from lineofaction.report.drawing.placing import placed

X, Y = Axis("time, s", "log", (1e-3, 1e5)), Axis("error, %", "log")
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
    found = placed(notes, X, Y, RANGE)
    assert [note.text for note in found] == [note.text for note in notes]
    ends = boxes(found)
    for i, (left, right, height) in enumerate(ends):
        assert left >= 0.0
        assert right <= 1.0
        for start, end, other in ends[:i]:
            assert end <= left or start >= right or abs(height - other) >= 0.069


def test_a_text_alone_stays_where_it_is():
    notes = (Note(1.0, 1.0, "plane strain"), Note(1e3, 1.0, "3d fine"))
    assert placed(notes, X, Y, RANGE) == notes


def test_a_text_at_the_top_goes_below_its_point():
    """Above it, it would run into the panel's title."""
    (note,) = placed([Note(1.0, 100.0, "iso6336")], X, Y, RANGE)
    assert note.row == -1


def test_a_text_at_the_bottom_stays_above_the_axis():
    """Its usual places are taken by its neighbors'."""
    names = ("3d draft 61 (chosen)", "3d standard 61 (knee)", "3d fine (reference)")
    notes = [Note(1.0 + k, 0.01, name) for k, name in enumerate(names)]
    assert min(note.row for note in placed(notes, X, Y, RANGE)) >= 0


def test_a_text_at_the_right_edge_goes_to_the_left():
    (note,) = placed([Note(9e4, 1.0, "full contact")], X, Y, RANGE)
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
    sheet = _panel_sheet((panel, panel))
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
    assert min(note.row for note in placed(notes, X, ending, RANGE)) >= 0
    assert min(note.row for note in placed(notes, X, Y, RANGE)) == -1
