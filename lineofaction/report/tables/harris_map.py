"""Harris map: transmission error over position at several loads, set apart in their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, FloatArray, Line, Panel, number

MOST_CURVES = 8
_APART = 1.1  # of what would let two neighbors touch
_LEAST = 0.15  # of the largest ripple, between neighbors that would not touch anyway
_ROOM = 0.04  # of the height


@dataclass(frozen=True)
class HarrisScale:
    """Offset from load to load, and the axis, µm; of maps that are compared one for all."""

    step: float
    axis: Axis

    @classmethod
    def of(cls, *maps: FloatArray) -> HarrisScale:
        """Return the scale on which no curve touches the next.

        `maps` (n, F) are curves less their means in µm, the loads rising.
        """
        ripple = max(float((np.nanmax(one, axis=0) - np.nanmin(one, axis=0)).max()) for one in maps)
        above = max(float(np.nanmax(one[:, :-1] - one[:, 1:], initial=0.0)) for one in maps)
        step = max(_APART * above, _LEAST * ripple) or 1.0
        drawn = np.concatenate([(one + step * np.arange(one.shape[1])).ravel() for one in maps])
        low, high = float(np.nanmin(drawn)), float(np.nanmax(drawn))
        room = _ROOM * (high - low) or 1.0
        label = f"STE, each load {number(step, 2)} µm higher, µm"
        return cls(step, Axis(label, limits=(low - room, high + room)))


def harris_panel(
    title: str, across: Axis, x: FloatArray, curves: FloatArray, names: Sequence[str], scale: HarrisScale
) -> Panel:
    """Draw the curves (n, F) in µm over `x`, each higher than the last, named at its end."""
    lines = tuple(
        Line(name, x, curves[:, k] + k * scale.step, palette.ordered(k, len(names)), label=name)
        for k, name in enumerate(names)
    )
    return Panel(across, scale.axis, lines, title=title)
