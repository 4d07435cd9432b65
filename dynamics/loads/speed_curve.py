"""A torque against speed: a motor's curve, a fan, dry friction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, increasing, positive
from dynamics.errors import InputError
from dynamics.types import FloatArray

Cubic = tuple[float, float, float, float]


@dataclass(frozen=True)
class SpeedCurve:
    """A resisting torque against the speed, piecewise cubic.

    Speed counts positive in the sense in which the kinematic motion turns the shaft, torque positive against
    that sense: a curve of a motor is negative where it drives.

    Attributes
    ----------
    speed : tuple of floats
        Where pieces join, rad/s, strictly increasing.
    coefficient : tuple of tuples of four floats
        Ascending in the speed above the piece's start, N m, N m s, ...; one piece more than joints. The
        first piece, below the first joint, counts from that joint too.
    """

    speed: tuple[float, ...]
    coefficient: tuple[Cubic, ...]

    def __post_init__(self) -> None:
        increasing("speed", self.speed)
        if len(self.coefficient) != len(self.speed) + 1:
            raise InputError("coefficient", len(self.coefficient), f"{len(self.speed) + 1} pieces")
        for index, piece in enumerate(self.coefficient):
            if len(piece) != 4:
                raise InputError(f"coefficient[{index}]", len(piece), "four coefficients")
            for value in piece:
                finite(f"coefficient[{index}]", value)

    @classmethod
    def table(cls, speed: Sequence[float], torque: Sequence[float]) -> SpeedCurve:
        """Return the curve through a table: no overshoot (Fritsch and Carlson), constant beyond the ends."""
        from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 (start-up time)

        speeds = increasing("speed", speed)
        if len(torque) != speeds.size or speeds.size < 2:
            raise InputError("torque", len(torque), f"as many values as speeds ({speeds.size}), at least 2")
        values = np.array([finite(f"torque[{index}]", value) for index, value in enumerate(torque)])
        pieces = PchipInterpolator(speeds, values).c[::-1].T
        first, last = [[values[0], 0.0, 0.0, 0.0]], [[values[-1], 0.0, 0.0, 0.0]]
        rows = np.concatenate([first, pieces, last]).tolist()
        return cls(tuple(speeds.tolist()), tuple((a, b, c, d) for a, b, c, d in rows))

    @classmethod
    def quadratic(cls, torque: float, speed: float) -> SpeedCurve:
        """Return torque (w / speed)^2, against the rotation at any sign of w: a fan."""
        factor = finite("torque", torque) / positive("speed", speed) ** 2
        return cls((0.0,), ((0.0, 0.0, -factor, 0.0), (0.0, 0.0, factor, 0.0)))

    @classmethod
    def constant(cls, torque: float, fade: float) -> SpeedCurve:
        """Return a torque against either sense of rotation, smooth from -fade to fade (rad/s)."""
        value, width = finite("torque", torque), 2.0 * positive("fade", fade)
        middle = (-value, 0.0, 6.0 * value / width**2, -4.0 * value / width**3)
        return cls((-fade, fade), ((-value, 0.0, 0.0, 0.0), middle, (value, 0.0, 0.0, 0.0)))

    @property
    def start(self) -> FloatArray:
        """Start of every piece, rad/s."""
        return np.array([self.speed[0], *self.speed])

    def __call__(self, speed: float | FloatArray) -> FloatArray:
        """Return the torque at `speed`."""
        value = np.asarray(speed, dtype=float)
        piece = np.searchsorted(np.asarray(self.speed), value, side="right")
        c, s = np.asarray(self.coefficient)[piece], value - self.start[piece]
        return np.asarray(c[..., 0] + s * (c[..., 1] + s * (c[..., 2] + s * c[..., 3])), dtype=float)
