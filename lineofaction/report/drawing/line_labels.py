"""Labels at the right ends of lines, spread so that none covers another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lineofaction.report.drawing.figure import Axis, FloatArray, Panel

_ROOM = 0.05  # of the height beyond the curves where the axis has no limits


class LineLabel(NamedTuple):
    """A label beside a panel; heights are parts of the panel's, 0 at the bottom.

    `end` is the height at which its line ends, `middle` that of the label.
    """

    text: str
    color: str
    end: float
    middle: float


def line_labels(panel: Panel, row: float) -> list[LineLabel]:
    """Return the labels of a panel's lines, each as near to its line's end as its neighbors allow.

    Parameters
    ----------
    panel : Panel
    row : float
        Height of one row of text, as a part of the panel's.
    """
    lines = [line for line in panel.lines if line.label and _shown(line.y, panel.y).size]
    ends = np.array([_shown(line.y, panel.y)[-1] for line in lines])
    heights = row * np.array([line.label.count("\n") + 1.3 for line in lines])
    at = np.clip(panel.y.fraction(ends, vertical_limits(panel)), 0.0, 1.0) if lines else ends
    middles = spread(at, heights)
    return [
        LineLabel(line.label, line.color, float(end), float(middle))
        for line, end, middle in zip(lines, at, middles, strict=True)
    ]


def spread(wanted: FloatArray, heights: FloatArray) -> FloatArray:
    """Return the middles of texts (n,) of given heights that lie apart and nearest to where they are wanted.

    The sum of squared shifts is least among all in this order (pool adjacent violators); then the stack is
    moved into 0 to 1, its top first.
    """
    order = np.argsort(wanted, kind="stable")
    below = np.cumsum(heights[order]) - 0.5 * heights[order]  # middle of each if all were stacked from 0
    blocks: list[tuple[float, int]] = []
    for offset in wanted[order] - below:
        mean, count = float(offset), 1
        while blocks and blocks[-1][0] >= mean:
            other, many = blocks.pop()
            mean, count = (mean * count + other * many) / (count + many), count + many
        blocks.append((mean, count))
    shift = np.concatenate([np.full(count, mean) for mean, count in blocks]) if blocks else np.empty(0)
    middles = np.empty(wanted.size)
    middles[order] = np.minimum(np.maximum(shift, 0.0), 1.0 - float(heights.sum())) + below
    return middles


def vertical_limits(panel: Panel) -> tuple[float, float]:
    """Return the ends of a panel's vertical axis: its own, or those of the curves with some room."""
    if panel.y.limits is not None:
        return panel.y.limits
    edges = [line.y + side * np.nan_to_num(line.band) for line in panel.lines for side in (-1.0, 1.0)]
    curves = edges if panel.y.scale == "linear" else [line.y for line in panel.lines]
    values = _shown(np.concatenate(curves), panel.y)
    low, high = (float(values.min()), float(values.max())) if values.size else (1.0, 1.0)
    if panel.y.scale == "log":
        room = (high / low) ** _ROOM if high > low else 2.0
        return low / room, high * room
    room = _ROOM * (high - low) or 1.0
    return low - room, high + room


def _shown(values: FloatArray, axis: Axis) -> FloatArray:
    return values[np.isfinite(values) & ((values > 0.0) | (axis.scale == "linear"))]
