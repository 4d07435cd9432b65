"""Texts beside points: none covers another, wherever the points lie."""

import numpy as np
import pytest

from service.report.figure import Axis, Note
from service.report.note_places import placed

X, Y = Axis("time, s", "log", (1e-3, 1e5)), Axis("error, %", "log")
RANGE = (0.01, 100.0)


def boxes(notes):
    """Left and right ends and heights of the texts, in parts of the panel, as they are drawn."""
    found = []
    for note in notes:
        across, along = (np.log10(note.x) + 3.0) / 8.0, (np.log10(note.y) + 2.0) / 4.0
        width, height = 0.0085 * len(note.text), along + 0.07 * note.row + (0.0 if note.row >= 0 else -0.05)
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
    """Its usual places are taken by its neighbours'."""
    names = ("3d draft 61 (chosen)", "3d standard 61 (knee)", "3d fine (reference)")
    notes = [Note(1.0 + k, 0.01, name) for k, name in enumerate(names)]
    assert min(note.row for note in placed(notes, X, Y, RANGE)) >= 0


def test_a_text_at_the_right_edge_goes_to_the_left():
    (note,) = placed([Note(9e4, 1.0, "full contact")], X, Y, RANGE)
    assert note.left
