"""A quantity over time: values with exact derivative and integral, or an angle by a smooth curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, increasing, not_negative, one_of, positive
from dynamics.errors import InputError
from dynamics.types import FloatArray

SHAPES = ("linear", "smooth")


@dataclass(frozen=True)
class TimeLaw:
    """Values at times, joined by straight lines or by smooth steps, constant before and after."""

    time: tuple[float, ...]
    """Times, s, strictly increasing."""
    value: tuple[float, ...]
    """Values at the times, as many as times; rad/s for a speed, N m for a torque."""
    shape: str = "linear"
    """``"linear"``: straight between the points. ``"smooth"``: cubic, with zero slope at each of them."""

    def __post_init__(self) -> None:
        increasing("time", self.time)
        if len(self.value) != len(self.time):
            raise InputError("value", len(self.value), f"as many values as times ({len(self.time)})")
        for index, value in enumerate(self.value):
            finite(f"value[{index}]", value)
        one_of("shape", self.shape, SHAPES)

    @classmethod
    def constant(cls, value: float) -> TimeLaw:
        """Return a constant law."""
        return cls((0.0,), (finite("value", value),))

    @classmethod
    def ramp(
        cls, start: float, end: float, duration: float, begin: float = 0.0, shape: str = "linear"
    ) -> TimeLaw:
        """Return a change from `start` to `end` over `duration` seconds from the time `begin` on."""
        begin = not_negative("begin", begin)
        return cls((begin, begin + positive("duration", duration)), (start, end), shape)

    def __call__(self, time: float | FloatArray) -> FloatArray:
        """Return the value at `time`."""
        moment = np.clip(np.asarray(time, dtype=float), self.time[0], self.time[-1])
        if len(self.time) == 1:
            return np.full_like(moment, self.value[0])
        index = np.clip(np.searchsorted(self.time, moment, side="right") - 1, 0, len(self.time) - 2)
        knot, coefficient = self.polynomials()
        elapsed = moment - knot[index + 1]
        c = coefficient[index + 1]
        return np.asarray(
            c[..., 0] + elapsed * (c[..., 1] + elapsed * (c[..., 2] + elapsed * c[..., 3])), dtype=float
        )

    def polynomials(self) -> tuple[FloatArray, FloatArray]:
        """Return start times (S,) and ascending cubic coefficients (S, 4) of the S = len(time) + 1 pieces.

        Piece 0 is the constant before the first time (its start is written as the first time), the last
        piece the constant after the last.
        """
        time, value = np.asarray(self.time), np.asarray(self.value)
        coefficient = np.zeros((time.size + 1, 4))
        coefficient[0, 0], coefficient[1:, 0] = value[0], value
        span, rise = np.diff(time), np.diff(value)
        if self.shape == "linear":
            coefficient[1:-1, 1] = rise / span
        else:
            coefficient[1:-1, 2], coefficient[1:-1, 3] = 3.0 * rise / span**2, -2.0 * rise / span**3
        return np.concatenate([time[:1], time]), coefficient

    @property
    def extreme(self) -> float:
        """The value of largest magnitude, with its sign."""
        return max(self.value, key=abs)


@dataclass(frozen=True)
class AngleLaw:
    """Angles at times, joined by a cubic spline: speed and acceleration are continuous.

    Before the first and after the last time the shaft turns on at the speed it has there. As a law it gives
    the speed, like `TimeLaw`; only differences of the angles matter.
    """

    time: tuple[float, ...]
    """s, strictly increasing, at least four."""
    angle: tuple[float, ...]
    """rad, of the same length."""

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
