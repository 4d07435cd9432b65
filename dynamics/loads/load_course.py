"""The course of a load: its factor over time (`TimeLaw`), by a shaft's speed, or by a shaft's angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bounds import above, at_least
from dynamics.checks import finite, increasing, positive
from dynamics.errors import InputError
from dynamics.loads.time_law import TimeLaw
from dynamics.types import FloatArray

Cubic = tuple[float, float, float, float]
LARGEST_DENOMINATOR = 1000
"""Orders are multiples of 1/d, d up to this: then they repeat after d turns."""
AGREEMENT = 1e-9
"""Relative difference of an order from such a multiple that the printing of its digits leaves."""
FAINT = 1e-12
"""Amplitude over the largest one, below which a harmonic of a tabulated turn is rounding."""
CONSTANT = TimeLaw.constant(1.0)


@dataclass(frozen=True)
class SpeedCurve:
    """A resisting torque against the speed, piecewise cubic.

    Speed counts positive in the sense in which the kinematic motion turns the shaft, torque positive against
    that sense: a curve of a motor is negative where it drives.
    """

    speed: tuple[float, ...]
    """Speeds at which pieces join, rad/s, strictly increasing."""
    coefficient: tuple[Cubic, ...]
    """Coefficients of the pieces, ascending in the speed above the piece's start, N m, N m s, ...; one piece
    more than joints. The first piece, below the first joint, counts from that joint too.
    """

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


@dataclass(frozen=True)
class BySpeed:
    """A factor by the speed of the shaft `shaft`, rad/s, in the sense in which the scene turns it."""

    curve: SpeedCurve
    shaft: str


@dataclass(frozen=True)
class Orders:
    """A factor by a shaft's angle: mean + sum of amplitude_k cos(order_k angle + phase_k)."""

    shaft: str
    """Whose angle: about +z, with the shaft's own vibration, 0 at t = 0."""
    order: tuple[float, ...]
    amplitude: tuple[float, ...]
    phase: tuple[float, ...]
    """`order`, `amplitude`, `phase`: Events per turn, > 0; factors; rad."""
    mean: float = 0.0

    def __post_init__(self) -> None:
        finite("mean", self.mean)
        for name in ("amplitude", "phase"):
            values = getattr(self, name)
            if len(values) != len(self.order):
                raise InputError(name, len(values), f"as many values as orders ({len(self.order)})")
            for index, value in enumerate(values):
                finite(f"{name}[{index}]", value)
        for index, order in enumerate(self.order):
            if not order > 0.0:
                raise InputError(f"order[{index}]", order, above(0.0), "A constant part is the mean.")
            if abs(float(_multiple(order)) - order) > AGREEMENT * order:
                bound = f"a multiple of 1/d with a whole number d up to {LARGEST_DENOMINATOR}"
                raise InputError(f"order[{index}]", order, bound, "Give fractions with ten digits.")

    @classmethod
    def table(cls, shaft: str, value: Sequence[float]) -> Orders:
        """Return the orders that go through `value` (N,), at N equal steps of the angle over one turn.

        It is the band-limited curve: the largest order is N/2.
        """
        values = np.array([finite(f"value[{index}]", entry) for index, entry in enumerate(value)])
        if values.size < 3:
            raise InputError("value", values.size, at_least(3, name="number of values,"))
        lines = np.fft.rfft(values) / values.size
        twice = np.where(np.arange(lines.size) * 2 == values.size, 1.0, 2.0) * lines
        orders = np.flatnonzero(np.abs(twice) > FAINT * np.max(np.abs(twice)))
        orders = orders[orders > 0]
        return cls(
            shaft,
            tuple(float(order) for order in orders),
            tuple(np.abs(twice[orders]).tolist()),
            tuple(np.angle(twice[orders]).tolist()),
            float(lines[0].real),
        )

    @property
    def multiple(self) -> tuple[Fraction, ...]:
        """The orders as fractions."""
        return tuple(_multiple(order) for order in self.order)

    @property
    def turns(self) -> int:
        """Turns of the shaft after which the factor repeats."""
        return math.lcm(*(order.denominator for order in self.multiple))

    def __call__(self, angle: float | FloatArray) -> FloatArray:
        """Return the factor at `angle`, rad."""
        at = np.asarray(angle, dtype=float)[..., None]
        waves = np.asarray(self.amplitude) * np.cos(np.asarray(self.order) * at + np.asarray(self.phase))
        return np.asarray(self.mean + np.sum(waves, axis=-1), dtype=float)


Course = TimeLaw | BySpeed | Orders


def mean_factor(course: Course, time: float | FloatArray, speed: float | FloatArray) -> FloatArray:
    """Return the mean over a turn at `time` (s) and the `speed` (rad/s) of its shaft in the shaft's sense."""
    if isinstance(course, TimeLaw):
        return course(time)
    if isinstance(course, BySpeed):
        return course.curve(speed)
    return np.full_like(np.asarray(time, dtype=float), course.mean)


def _multiple(order: float) -> Fraction:
    return Fraction(order).limit_denominator(LARGEST_DENOMINATOR)
