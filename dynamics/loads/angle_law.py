"""An angle given over time: a smooth curve through a table, with its speed and acceleration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, increasing
from dynamics.errors import InputError
from dynamics.types import FloatArray


@dataclass(frozen=True)
class AngleLaw:
    """Angles at times, joined by a cubic spline: speed and acceleration are continuous.

    Before the first and after the last time the shaft turns on at the speed it has there. As a law it gives
    the speed, like `TimeLaw`; only differences of the angles matter.

    Attributes
    ----------
    time : tuple of floats
        s, strictly increasing, at least four.
    angle : tuple of floats
        rad, of the same length.
    """

    time: tuple[float, ...]
    angle: tuple[float, ...]

    def __post_init__(self) -> None:
        increasing("time", self.time)
        if len(self.time) < 4:
            raise InputError("time", len(self.time), "at least 4 times", "Or give the speed over time.")
        if len(self.angle) != len(self.time):
            raise InputError("angle", len(self.angle), f"as many values as times ({len(self.time)})")
        for index, value in enumerate(self.angle):
            finite(f"angle[{index}]", value)

    def __call__(self, time: float | FloatArray) -> FloatArray:
        """Return the speed at `time`, rad/s."""
        start, c = self.polynomials()
        moment = np.asarray(time, dtype=float)
        piece = np.searchsorted(start[1:], moment, side="right")
        s = moment - start[piece]
        return np.asarray(c[piece, 0] + s * (c[piece, 1] + s * c[piece, 2]), dtype=float)

    def polynomials(self) -> tuple[FloatArray, FloatArray]:
        """Return start times and ascending coefficients of the speed, as `TimeLaw.polynomials` does."""
        from scipy.interpolate import CubicSpline  # noqa: PLC0415 (start-up time)

        time = np.asarray(self.time)
        spline = CubicSpline(time, np.asarray(self.angle))
        speed = spline.derivative()
        coefficient = np.zeros((time.size + 1, 4))
        coefficient[1:-1, :3] = speed.c[::-1].T
        coefficient[0, 0], coefficient[-1, 0] = speed(time[0]), speed(time[-1])
        return np.concatenate([time[:1], time]), coefficient

    @property
    def extreme(self) -> float:
        """The speed of largest magnitude at the times, with its sign, rad/s."""
        speeds = self(np.asarray(self.time))
        return float(speeds[np.argmax(np.abs(speeds))])
