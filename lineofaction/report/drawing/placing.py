"""Points, notes and labels of a plot: their number and their places; and the rewriting of its texts.

A note is a short text beside a point of a curve. Places are parts of the panel, 0 to 1 from left and bottom.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np

from lineofaction.report.drawing.figure import Axis, FloatArray, Note, Panel

_CHARACTER, _HEIGHT, _GAP, _RISE = 0.0072, 0.07, 0.008, 0.05
"""Width of a character, height of a text, distance from its point, and rise above it.

They are those of an 8 point text in a panel of the usual size, over the panel's width and height.
"""
_POINT_WIDTH, _POINT_HEIGHT = 0.012, 0.05  # of a marker, over the panel's width and height
_MARGIN = 0.05
"""Margin over the height of the panel, above its curves, and below them where the axis has no limits. A text
beyond the margin runs into the title or the axis."""
_PLACES = [(row, left) for row in (0, -1, 1, -2, 2, -3, 3) for left in (False, True)]
"""Rows above (> 0) or below a note's usual place, and whether the text ends at the point."""
_STACKED = 0.085
"""Least distance of texts that stand above each other, over the height of a wide panel: that of an 8 point
text in its white box."""
_TAIL = 0.02  # length of a leader over the width of the panel
_WIDE_CHARACTER = 0.0095  # width of a character over that of a panel beside a color bar, or on a page
_ROOM = 0.05  # share of the height above and below the curves of an axis without limits
_LEADING = 0.3  # distance of two labels, in rows of text
Description = TypeVar("Description")


def envelope(time: FloatArray, values: FloatArray, columns: int = 1200) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest sample of each of `columns` stretches, in their order in time.

    A line through them covers the same pixels as the whole series. A short series is returned whole.
    """
    size = len(time)
    if size <= 2 * columns:
        return time, values
    edges = np.linspace(0, size, columns + 1).astype(int)
    extremes = [a + np.sort([np.argmin(values[a:b]), np.argmax(values[a:b])]) for a, b in pairwise(edges)]
    index = np.unique(np.concatenate([[0], *extremes, [size - 1]]))
    return time[index], values[index]


class _Box(NamedTuple):
    """A rectangle in parts of the panel."""

    left: float
    right: float
    low: float
    high: float

    def covers(self, other: _Box) -> bool:
        """Whether both share more than an edge."""
        is_disjoint = self.right <= other.left or other.right <= self.left
        return not (is_disjoint or self.high <= other.low or other.high <= self.low)


def placed(notes: Sequence[Note], x: Axis, y: Axis, y_range: tuple[float, float]) -> tuple[Note, ...]:
    """Return the notes in their order, moved to where no text covers another or a point.

    Parameters
    ----------
    x, y : Axis
        Axes of the panel; `x` has limits, and `y` too if the panel ends with `y_range`.
    y_range : (float, float)
        Values between which the panel's curves lie.
    """
    across = x.fraction(np.array([note.x for note in notes]), x.limits or (0.0, 1.0))
    along = y.fraction(np.array([note.y for note in notes]), y_range)
    width, height = 0.5 * _POINT_WIDTH, 0.5 * _POINT_HEIGHT
    taken = [
        _Box(left=a - width, right=a + width, low=b - height, high=b + height)
        for a, b in zip(across, along, strict=True)
    ]
    shifted = list(notes)
    lowest = -_MARGIN if y.limits is None else 0.0
    for k in np.argsort(across, kind="stable"):
        boxes = {slot: _text(notes[k].text, across[k], along[k], *slot) for slot in _PLACES}
        slot = next((at for at, box in boxes.items() if _is_free(box, taken, lowest)), _PLACES[0])
        taken.append(boxes[slot])
        shifted[k] = replace(notes[k], row=slot[0], left=slot[1])
    return tuple(shifted)


def _text(text: str, x: float, y: float, row: int, left: bool, character: float = _CHARACTER) -> _Box:
    """Return the box of a text at the point (x, y)."""
    width = character * len(text)
    low = y + row * _HEIGHT - 0.5 * _HEIGHT + (_RISE if row >= 0 else 0.0)
    start = x - _GAP - width if left else x + _GAP
    return _Box(left=start, right=start + width, low=low, high=low + _HEIGHT)


def _is_free(box: _Box, boxes: Sequence[_Box], lowest: float) -> bool:
    """Whether a text lies in the panel and covers nothing."""
    across = box.left >= 0.0 and box.right <= 1.0
    along = box.low >= lowest and box.high <= 1.0 + _MARGIN
    return across and along and not any(box.covers(other) for other in boxes)


def stacked(notes: Sequence[Note], x: Axis, y: Axis) -> tuple[Note, ...]:
    """Return notes at the left edge of a panel, each with a leader to a text that covers no other.

    The texts stand above each other in the order of their points and as near to them as they can. Both axes
    have limits and are linear.
    """
    left, right = x.limits or (0.0, 1.0)
    low, high = y.limits or (0.0, 1.0)
    height = min(_STACKED, 1.0 / max(len(notes), 1))
    middles = spread_positions(
        y.fraction(np.array([note.y for note in notes]), (low, high)), np.full(len(notes), height)
    )
    start = left + _TAIL * (right - left)
    return tuple(
        replace(note, tail=(start, float(low + middle * (high - low))))
        for note, middle in zip(notes, middles, strict=True)
    )


def named_along(
    curves: Sequence[tuple[str, FloatArray, FloatArray]], x: Axis, y: Axis, others: Sequence[Note] = ()
) -> tuple[Note, ...]:
    """Return a note with the name of each curve, above left of one of its points, none over another.

    A name stands at the first point of its curve where it covers neither an earlier name nor a text of the
    `others`, which have tails; a curve without such a point has none. Both axes have limits.

    Parameters
    ----------
    curves : sequence of (str, (n,) array, (n,) array)
        Name, and points of the curve, the best place for its name first.
    """
    x_ends, y_ends = x.limits or (0.0, 1.0), y.limits or (0.0, 1.0)
    taken = [_tailed(note, x, y) for note in others]
    notes = []
    for name, at, height in curves:
        across, along = x.fraction(at, x_ends), y.fraction(height, y_ends)
        for k in range(len(at)):
            box = _text(name, float(across[k]), float(along[k]), 0, left=True, character=_WIDE_CHARACTER)
            if _is_free(box, taken, 0.0):
                taken.append(box)
                notes.append(Note(float(at[k]), float(height[k]), name, left=True))
                break
    return tuple(notes)


def _tailed(note: Note, x: Axis, y: Axis) -> _Box:
    """Return the box of a text that begins at its tail."""
    start, middle = note.tail or (note.x, note.y)
    left = float(x.fraction(np.array(start), x.limits or (0.0, 1.0)))
    at = float(y.fraction(np.array(middle), y.limits or (0.0, 1.0)))
    right = left + _WIDE_CHARACTER * len(note.text)
    return _Box(left=left, right=right, low=at - 0.5 * _STACKED, high=at + 0.5 * _STACKED)


class _LineLabel(NamedTuple):
    """A label at the side of a panel; heights are shares of the panel's height, 0 at the bottom.

    `end` is the height at which its line ends, `middle` that of the label.
    """

    text: str
    color: str
    end: float
    middle: float


def line_labels(panel: Panel, row: float) -> list[_LineLabel]:
    """Return the labels of a panel's lines, each as near to its line's end as its neighbors allow.

    `row`: height of one row of text, as a part of the panel's.
    """
    lines = [line for line in panel.lines if line.label and _drawable(line.y, panel.y).size]
    ends = np.array([_drawable(line.y, panel.y)[-1] for line in lines])
    heights = row * np.array([line.label.count("\n") + 1.0 + _LEADING for line in lines])
    at = np.clip(panel.y.fraction(ends, vertical_limits(panel)), 0.0, 1.0) if lines else ends
    middles = spread_positions(at, heights)
    return [
        _LineLabel(text=line.label, color=line.color, end=float(end), middle=float(middle))
        for line, end, middle in zip(lines, at, middles, strict=True)
    ]


def spread_positions(wanted: FloatArray, heights: FloatArray) -> FloatArray:
    """Return the middles of texts (n,) of given heights without overlap, nearest to the wanted places.

    The sum of squared shifts is least among all in this order (pool adjacent violators); then the stack is
    moved into 0 to 1, its top first.
    """
    order = np.argsort(wanted, kind="stable")
    below = np.cumsum(heights[order]) - 0.5 * heights[order]  # middle of each if all were stacked from 0
    blocks: list[tuple[float, int]] = []  # mean shift, and number of texts that have it
    for offset in wanted[order] - below:
        mean, count = float(offset), 1
        while blocks and blocks[-1][0] >= mean:
            other_mean, other_count = blocks.pop()
            mean = (mean * count + other_mean * other_count) / (count + other_count)
            count += other_count
        blocks.append((mean, count))
    shift = np.concatenate([np.full(count, mean) for mean, count in blocks]) if blocks else np.empty(0)
    middles = np.empty(wanted.size)
    middles[order] = np.minimum(np.maximum(shift, 0.0), 1.0 - float(heights.sum())) + below
    return middles


def vertical_limits(panel: Panel) -> tuple[float, float]:
    """Return the ends of a panel's vertical axis: stated limits, or the ends of the curves with a margin."""
    if panel.y.limits is not None:
        return panel.y.limits
    edges = [line.y + side * np.nan_to_num(line.band) for line in panel.lines for side in (-1.0, 1.0)]
    curves = edges if panel.y.scale == "linear" else [line.y for line in panel.lines]
    values = _drawable(np.concatenate(curves), panel.y)
    low, high = (float(values.min()), float(values.max())) if values.size else (1.0, 1.0)
    if panel.y.scale == "log":
        room = (high / low) ** _ROOM if high > low else 2.0
        return low / room, high * room
    room = _ROOM * (high - low) or 1.0
    return low - room, high + room


def _drawable(values: FloatArray, axis: Axis) -> FloatArray:
    return values[np.isfinite(values) & ((values > 0.0) | (axis.scale == "linear"))]


def rewritten(description: Description, write: Callable[[str], str]) -> Description:
    """Return a description with all its texts rewritten; colors and the like hold nothing to rewrite."""
    part: Any = description
    if isinstance(part, str):
        part = write(part)
    elif isinstance(part, tuple):
        part = tuple(rewritten(entry, write) for entry in part)
    elif is_dataclass(part) and not isinstance(part, type):
        changes = {field.name: rewritten(getattr(part, field.name), write) for field in fields(part)}
        part = replace(part, **changes)
    return cast(Description, part)
