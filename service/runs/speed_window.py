"""A few base pitches of a run at the moment it passes a speed."""

from __future__ import annotations

import numpy as np

from service.drawing.figure import FloatArray

PITCHES = 3


def window_speeds(speed: FloatArray, fractions: tuple[float, ...] = (0.1, 0.4, 0.9)) -> tuple[float, ...]:
    """Choose speeds to look at: fractions of the highest one, rounded but never above it."""
    highest = float(np.max(np.abs(speed)))
    chosen = [_rounded(fraction * highest, highest) for fraction in fractions]
    return tuple(dict.fromkeys(value for value in chosen if value > 0.0))


def _rounded(value: float, highest: float) -> float:
    """Round to one digit, to two where that would exceed the highest."""
    short = float(f"{value:.1g}")
    return short if short <= highest else float(f"{value:.2g}")


def speed_window(position: FloatArray, speed: FloatArray, target: float, pitches: int = PITCHES) -> slice:
    """Return the samples of `pitches` whole base pitches around the first passing of the speed `target`.

    Parameters
    ----------
    position : (n,) array
        Position of the driving gear in base pitches, not wrapped, monotone.
    speed : (n,) array
        Speed at the samples; its magnitude counts.
    target : float
        In the unit of `speed`.
    """
    traveled = np.abs(position - position[0])
    passing = int(np.argmax(np.abs(speed) >= target)) or int(np.argmin(np.abs(np.abs(speed) - target)))
    first = min(np.floor(traveled[passing] - pitches / 2), np.floor(traveled[-1]) - pitches)
    start = int(np.searchsorted(traveled, max(first, 0.0)))
    stop = int(np.searchsorted(traveled, max(first, 0.0) + pitches, side="right"))
    return slice(start, max(stop, start + 2))
