"""Short texts beside points that lie close together: none covers another, nor a point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lineofaction.report.drawing.figure import Axis, Note

# of an 8 point text in a panel of the usual size, in parts of its width and height
_CHARACTER, _HEIGHT, _GAP, _RISE = 0.0072, 0.07, 0.008, 0.05
_POINT_WIDTH, _POINT_HEIGHT = 0.012, 0.05
_MARGIN = 0.05
"""Of the panel above its curves, and below them where the axis has no limits: what goes beyond it runs into
the title or the axis."""
_PLACES = [(row, left) for row in (0, -1, 1, -2, 2, -3, 3) for left in (False, True)]
"""Rows above (> 0) or below a note's usual place, and whether the text ends at the point."""


class _Box(NamedTuple):
    """A rectangle in parts of the panel."""

    left: float
    right: float
    low: float
    high: float

    def covers(self, other: _Box) -> bool:
        """Whether both share more than an edge."""
        apart = self.right <= other.left or other.right <= self.left
        return not (apart or self.high <= other.low or other.high <= self.low)


def placed(notes: Sequence[Note], x: Axis, y: Axis, y_range: tuple[float, float]) -> tuple[Note, ...]:
    """Return the notes in their order, moved to where no text covers another or a point.

    Parameters
    ----------
    notes : sequence of Note
    x, y : Axis
        Of the panel; `x` with limits, and `y`, too, where the panel ends with `y_range`.
    y_range : (float, float)
        Values between which the panel's curves lie.
    """
    across = x.fraction(np.array([note.x for note in notes]), x.limits or (0.0, 1.0))
    along = y.fraction(np.array([note.y for note in notes]), y_range)
    size = 0.5 * _POINT_WIDTH, 0.5 * _POINT_HEIGHT
    taken = [
        _Box(a - size[0], a + size[0], b - size[1], b + size[1]) for a, b in zip(across, along, strict=True)
    ]
    moved, lowest = list(notes), -_MARGIN if y.limits is None else 0.0
    for k in np.argsort(across, kind="stable"):
        boxes = {slot: _text(notes[k].text, across[k], along[k], *slot) for slot in _PLACES}
        slot = next((at for at, box in boxes.items() if _is_free(box, taken, lowest)), _PLACES[0])
        taken.append(boxes[slot])
        moved[k] = replace(notes[k], row=slot[0], left=slot[1])
    return tuple(moved)


def _text(text: str, x: float, y: float, row: int, left: bool) -> _Box:
    """Return the box of a text beside the point (x, y)."""
    width, low = _CHARACTER * len(text), y + row * _HEIGHT - 0.5 * _HEIGHT + (_RISE if row >= 0 else 0.0)
    start = x - _GAP - width if left else x + _GAP
    return _Box(start, start + width, low, low + _HEIGHT)


def _is_free(box: _Box, taken: Sequence[_Box], lowest: float) -> bool:
    """Whether a text lies in the panel and covers nothing."""
    across = box.left >= 0.0 and box.right <= 1.0
    along = box.low >= lowest and box.high <= 1.0 + _MARGIN
    return across and along and not any(box.covers(other) for other in taken)
