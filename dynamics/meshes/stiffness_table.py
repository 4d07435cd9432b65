"""Mesh-force tables of a closed form: F = k(x) (d - e(x)) in contact, k and e periodic in a base pitch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, increasing, positive
from dynamics.errors import InputError
from dynamics.meshes.standard_sliding import StandardTeeth, sliding_positions, standard_sliding
from dynamics.meshes.technique import PlainTable
from dynamics.types import FloatArray

PER_HARMONIC = 64
"""Knots per period of the highest harmonic: cubic pieces are then within 2.5e-7 of its amplitude."""
LEVEL = 1e3
"""Force of a table's second level, N. Its size is arbitrary: the force is linear from lift-off on."""


@dataclass(frozen=True)
class PeriodicCurve:
    """A curve of period 1: cubic between knots (P,) in [0, 1), with values and slopes there.

    Made by `constant`, `harmonic` or `tabulated`.
    """

    position: FloatArray
    value: FloatArray
    slope: FloatArray

    @classmethod
    def constant(cls, value: float) -> PeriodicCurve:
        """Return a curve of one value."""
        return cls(np.array([0.0, 0.5]), np.full(2, finite("value", value)), np.zeros(2))

    @classmethod
    def harmonic(cls, mean: float, amplitude: Sequence[float], phase: Sequence[float]) -> PeriodicCurve:
        """Return mean + sum over n = 1, 2, ... of amplitude_n cos(2 pi n x + phase_n), phases in rad."""
        if len(phase) != len(amplitude):
            raise InputError("phase", len(phase), f"as many values as amplitudes ({len(amplitude)})")
        order = 2.0 * np.pi * np.arange(1, len(amplitude) + 1)
        count = PER_HARMONIC * max(len(amplitude), 1)
        knots = np.arange(count) / count
        angle = np.outer(knots, order) + np.asarray(phase, dtype=float)
        size = np.asarray(amplitude, dtype=float)
        return cls(knots, mean + np.cos(angle) @ size, -np.sin(angle) @ (size * order))

    @classmethod
    def tabulated(cls, position: Sequence[float], value: Sequence[float]) -> PeriodicCurve:
        """Return the curve through values at positions in [0, 1), at least two.

        It overshoots nothing (Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238-246).
        """
        from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 (start-up time)

        knots = increasing("position", position)
        if knots.size < 2 or knots[0] < 0.0 or knots[-1] >= 1.0:
            raise InputError("position", knots.tolist(), "at least two values, in [0, 1)")
        if len(value) != knots.size:
            raise InputError("value", len(value), f"as many values as positions ({knots.size})")
        around = np.concatenate([knots[-2:] - 1.0, knots, knots[:2] + 1.0])
        values = np.asarray(value, dtype=float)
        cubic = PchipInterpolator(around, np.concatenate([values[-2:], values, values[:2]]))
        return cls(knots, values, np.asarray(cubic.derivative()(knots)))

    def __call__(self, position: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return values and slopes at `position`."""
        knots = np.append(self.position, self.position[0] + 1.0)
        at = knots[0] + (np.asarray(position, dtype=float) - knots[0]) % 1.0
        k = np.searchsorted(knots[1:-1], at, side="right")
        after = (k + 1) % self.position.size
        width = knots[k + 1] - knots[k]
        # Hermite's cubic: value + slope x + start x^2 + bend x^3
        secant = (self.value[after] - self.value[k]) / width
        bend = (self.slope[k] + self.slope[after] - 2.0 * secant) / width**2
        start = (secant - self.slope[k]) / width - bend * width
        x = at - knots[k]
        value = self.value[k] + x * (self.slope[k] + x * (start + x * bend))
        return value, self.slope[k] + x * (2.0 * start + 3.0 * x * bend)


def stiffness_table(
    stiffness: PeriodicCurve, error: PeriodicCurve | None = None, teeth: StandardTeeth | None = None
) -> PlainTable:
    """Return the table of F = k(x) (d - e(x)), 0 below d = e(x); x in base pitches of the driving gear.

    Exact at the knots of both curves; between them F is that of cubic pieces of k, e and 1/k. Raises
    `InputError`: the stiffness is not above 0 at a knot.

    Parameters
    ----------
    stiffness : PeriodicCurve
        k along the transverse line of action, N/m.
    error : PeriodicCurve, optional
        e, transmission error without load, m; left out: none.
    teeth : StandardTeeth, optional
        Teeth whose sliding the table has; left out: it has none.
    """
    error = error or PeriodicCurve.constant(0.0)
    position = np.union1d(stiffness.position, error.position)
    if teeth is not None:
        position = sliding_positions(position)
    (k, k_slope), (e, e_slope) = stiffness(position), error(position)
    if np.any(k <= 0.0):
        raise InputError("value", float(np.min(k)), "above 0 N/m at all positions, as a stiffness")
    # gives curves the shape of a table: misalignments, center distances, positions, and the two levels
    twice = np.ones((1, 1, 1, 2))
    level = np.array([0.0, LEVEL])
    sliding = None if teeth is None else standard_sliding(teeth, position)
    return PlainTable(
        position=position,
        level=level,
        misalignment=np.zeros(1),
        center_distance_change=np.zeros(1),
        deflection=e[:, None] + level / k[:, None] + 0.0 * twice,
        deflection_slope=e_slope[:, None] - level * (k_slope / k**2)[:, None] + 0.0 * twice,
        stiffness=k[:, None] * twice,
        stiffness_slope=k_slope[:, None] * twice,
        sliding_share=None if sliding is None else sliding[0][:, None] * twice,
        sliding_lever=None if sliding is None else sliding[1][:, None] * twice,
    )


def straight_table(stiffness: float, teeth: StandardTeeth | None = None) -> PlainTable:
    """Return the table of a flank of the same stiffness at all positions: F = stiffness d, in contact only.

    `stiffness`: along the transverse line of action, N/m; `teeth` as of `stiffness_table`. Raises
    `InputError`: it is not above 0.
    """
    return stiffness_table(PeriodicCurve.constant(positive("stiffness", stiffness)), teeth=teeth)
