"""A few base pitches of a run at the moment it passes a speed."""

from __future__ import annotations

import numpy as np

from lineofaction.report.drawing.figure import FloatArray

PITCHES = 3
STEADY = 0.1
"""Greatest change of speed over a run, of the highest, at which it has one speed alone."""


def window_speeds(speed: FloatArray, fractions: tuple[float, ...] = (0.1, 0.4, 0.9)) -> tuple[float, ...]:
    """Choose speeds to look at: fractions of the highest one that the run passes, rounded but never above it.

    Of a run at one speed, and of one that passes none of them, that at its end.
    """
    highest, lowest = float(np.max(np.abs(speed))), float(np.min(np.abs(speed)))
    chosen = [_rounded(fraction * highest, highest) for fraction in fractions]
    passed = tuple(dict.fromkeys(value for value in chosen if value > 0.0 and value >= lowest))
    return (_at_end(speed),) if is_steady(speed) or not passed else passed


def is_steady(speed: FloatArray) -> bool:
    """Return whether a run has one speed alone."""
    size = np.abs(speed)
    return bool(np.ptp(size) <= STEADY * np.max(size))


def _at_end(speed: FloatArray) -> float:
    """Return the last speed, to four digits."""
    return float(f"{abs(speed[-1]):.4g}")


def _rounded(value: float, highest: float) -> float:
    """Round to one digit, to two where that would exceed the highest."""
    short = float(f"{value:.1g}")
    return short if short <= highest else float(f"{value:.2g}")


def speed_window(position: FloatArray, speed: FloatArray, target: float, pitches: int = PITCHES) -> slice:
    """Return the samples of `pitches` whole base pitches around the first passing of the speed `target`.

    Of a run at one speed the last ones, where what began with it has died away.

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
    if is_steady(speed):
        passing = traveled.size - 1
    first = min(np.floor(traveled[passing] - pitches / 2), np.floor(traveled[-1]) - pitches)
    start = int(np.searchsorted(traveled, max(first, 0.0)))
    stop = int(np.searchsorted(traveled, max(first, 0.0) + pitches, side="right"))
    return slice(start, max(stop, start + 2))
