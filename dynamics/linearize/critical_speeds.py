"""Critical speeds: where multiples of a mesh frequency meet the frequency of a mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.linearize.campbell import WhirlBranches, likeness, modes_at
from dynamics.linearize.linear_system import LinearSystem
from dynamics.linearize.speeds import mesh_frequencies
from dynamics.system.assemble import System
from dynamics.types import FloatArray, IntArray

CLOSE = 1e-9  # of the frequency: residual of a crossing
ITERATIONS = 20


@dataclass(frozen=True)
class CriticalSpeeds:
    """Crossings, C of them by rising speed.

    Attributes
    ----------
    speed : (C,) array
        Of the leading law, rad/s.
    frequency, damping_ratio : (C,) arrays
        Of the mode there, Hz.
    mode, mesh, order : (C,) int arrays
        Branch, mesh, and multiple of its mesh frequency.
    residual : (C,) array
        Frequency of the mode less that of the order, Hz.
    """

    speed: FloatArray
    frequency: FloatArray
    damping_ratio: FloatArray
    mode: IntArray
    mesh: IntArray
    order: IntArray
    residual: FloatArray


def critical_speeds(
    system: System, linear: LinearSystem, branches: WhirlBranches, orders: int
) -> CriticalSpeeds:
    """Return where the orders 1 to `orders` of every mesh meet the modes within the speeds of `branches`.

    Meshes that share a mesh frequency count once, under the name of the first. Between two speeds the
    crossing is refined on the mode itself: speed = frequency(speed) / (order x mesh frequency per speed).
    """
    per_speed = mesh_frequencies(system, np.ones(1))[:, 0]
    rows: list[tuple[float, ...]] = []
    for mesh, rate in enumerate(per_speed):
        if rate == 0.0 or np.any(np.isclose(per_speed[:mesh], rate, rtol=1e-9, atol=0.0)):
            continue
        for order in range(1, orders + 1):
            gap = branches.frequency - order * rate * branches.speed[:, None]
            crossed = (gap[:-1] > 0.0) & (gap[1:] <= 0.0) | (gap[:-1] < 0.0) & (gap[1:] >= 0.0)
            for row, mode in zip(*np.nonzero(crossed), strict=True):
                found = _refined(system, linear, branches, int(row), int(mode), order * rate)
                rows.append((*found, float(mode), float(mesh), float(order)))
    table = np.array(sorted(rows)).reshape(-1, 7)
    counts = table[:, 4:].astype(np.int64)
    return CriticalSpeeds(
        table[:, 0], table[:, 1], table[:, 2], counts[:, 0], counts[:, 1], counts[:, 2], table[:, 3]
    )


def _refined(
    system: System, linear: LinearSystem, branches: WhirlBranches, row: int, mode: int, rate: float
) -> tuple[float, float, float, float]:
    """Return speed, frequency, damping ratio and residual of a crossing between two of the speeds."""
    speeds, lines = branches.speed[row : row + 2], branches.frequency[row : row + 2, mode]
    gap = lines - rate * speeds
    weight = gap[0] / (gap[0] - gap[1])
    speed = float(speeds[0] + weight * (speeds[1] - speeds[0]))
    near = branches.shape[row + round(float(weight)), mode][None, :]
    for _ in range(ITERATIONS):
        modes = modes_at(system, linear, speed)
        which = int(np.argmax(likeness(linear, near, modes.shape)[0]))
        frequency = float(modes.frequency[which])
        left = frequency - rate * speed
        if abs(left) <= CLOSE * frequency:
            break
        speed = float(np.clip(frequency / rate, speeds[0], speeds[1]))
    return speed, frequency, float(modes.damping_ratio[which]), left
