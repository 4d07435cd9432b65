"""Critical speeds: speeds at which a multiple of a mesh frequency meets the frequency of a mode.

The leading law is the first drive or free rotation that turns; speeds are its speed. A branch is one whirl
mode over all speeds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize.campbell import WhirlBranches, likeness, modes_at
from dynamics.linearize.linear_system import LinearSystem
from dynamics.linearize.operating_speeds import mesh_frequencies
from dynamics.linearize.speed_matrices import SpeedMatrices, speed_matrices
from dynamics.types import ComplexArray, FloatArray, IntArray

CLOSE = 1e-9  # last step of a crossing over the eigenvalue; the error is of the order of its square
ITERATIONS = 12  # most Newton steps to a crossing
HALVINGS = 12  # most halvings of an interval with a crossing
ALIKE = 0.5  # modal assurance with the mode at either speed


@dataclass(frozen=True)
class CriticalSpeeds:
    """Crossings, C of them by rising speed."""

    speed: FloatArray
    """Speed of the leading law at each crossing, rad/s. Shape (C,)."""
    frequency: FloatArray
    damping_ratio: FloatArray
    """`frequency`, `damping_ratio`: Frequency, Hz, and damping ratio of the mode at the crossing. Shape (C,)
    each.
    """
    mode: IntArray
    mesh: IntArray
    order: IntArray
    """`mode`, `mesh`, `order`: Branch, mesh, and multiple of its mesh frequency. Shape (C,) each."""
    residual: FloatArray
    """Residual of the eigenvalue problem at the crossing, as an error of the frequency, Hz. Shape (C,)."""


def critical_speeds(
    system: System, linear: LinearSystem, branches: WhirlBranches, orders: int
) -> CriticalSpeeds:
    """Return where the orders 1 to `orders` of every mesh meet the modes within the speeds of `branches`.

    Meshes that share a mesh frequency count once, under the name of the first. Between two speeds Newton's
    method finds eigenvector, damping and speed together.
    """
    turns = float(np.max(branches.speed, initial=0.0))
    matrices = speed_matrices(system, linear, turns) if turns > 0.0 else None
    per_speed = mesh_frequencies(system, np.ones(1))[:, 0] if branches.speed.size else np.empty(0)
    rows: list[tuple[_Crossing, int, int, int]] = []
    for mesh, rate in enumerate(per_speed):
        if rate == 0.0 or np.any(np.isclose(per_speed[:mesh], rate, rtol=1e-9, atol=0.0)):
            continue
        for order in range(1, orders + 1):
            gap = branches.frequency - order * rate * branches.speed[:, None]
            crossed = (gap[:-1] > 0.0) & (gap[1:] <= 0.0) | (gap[:-1] < 0.0) & (gap[1:] >= 0.0)
            for row, mode in zip(*np.nonzero(crossed), strict=True):
                assert matrices is not None  # between two speeds one is not 0
                between = _between(branches, int(row), int(mode), order * rate)
                crossing = _refined_crossing(system, linear, matrices, between)
                rows.append((crossing, int(mode), mesh, order))
    rows.sort()
    counts = np.array([row[1:] for row in rows], dtype=np.int64).reshape(-1, 3)
    figures = {
        name: np.array([getattr(crossing, name) for crossing, *_ in rows], dtype=float)
        for name in _Crossing._fields
    }
    return CriticalSpeeds(**figures, mode=counts[:, 0], mesh=counts[:, 1], order=counts[:, 2])


class _Crossing(NamedTuple):
    """Figures of a crossing, as `CriticalSpeeds` has them."""

    speed: float
    frequency: float
    damping_ratio: float
    residual: float


@dataclass(frozen=True)
class _Between:
    """Two speeds, rad/s, between which a mode of `shape` (2, n) meets a line of `rate` Hz per rad/s.

    `gap` (2,) is the frequency of the mode less that of the line, Hz.
    """

    speed: FloatArray
    gap: FloatArray
    frequency: FloatArray
    damping_ratio: FloatArray
    shape: ComplexArray
    rate: float

    @property
    def weight(self) -> float:
        """Part of the interval, 0 to 1, at which the gap closes if it is straight."""
        return float(self.gap[0] / (self.gap[0] - self.gap[1]))


def _between(branches: WhirlBranches, row: int, mode: int, rate: float) -> _Between:
    """Return a mode at two neighboring speeds."""
    both = slice(row, row + 2)
    speed, frequency = branches.speed[both], branches.frequency[both, mode]
    ratio, shape = branches.damping_ratio[both, mode], branches.shape[both, mode]
    return _Between(speed, frequency - rate * speed, frequency, ratio, shape, rate)


def _refined_crossing(
    system: System, linear: LinearSystem, matrices: SpeedMatrices, between: _Between
) -> _Crossing:
    """Find a crossing.

    Where Newton's method leaves the two speeds or the mode (modes that veer), they are halved: the mode in
    the middle is that most like the ends.
    """
    for _ in range(HALVINGS):
        crossing = _newton(linear, matrices, between)
        if crossing is not None:
            return crossing
        between = _halved_interval(system, linear, between)
    end = int(np.argmin(np.abs(between.gap)))
    values = (between.speed, between.frequency, between.damping_ratio, between.gap)
    return _Crossing(*(float(value[end]) for value in values))


def _newton(linear: LinearSystem, matrices: SpeedMatrices, between: _Between) -> _Crossing | None:
    """Solve P(s, W) x = 0 with Im s = 2 pi rate W for x, Re s and W; None without convergence to it.

    The steps x + dx = -P^-1 (P_s ds + P_W dW) x keep c^H x = 1, c along the first guess: a complex equation
    for the two real unknowns.
    """
    low, high = between.speed
    nearest = round(between.weight)
    speed = float(low + between.weight * (high - low))
    per_speed = 2.0 * math.pi * between.rate
    ratio = float(np.interp(speed, between.speed, between.damping_ratio))
    decay = -ratio / math.sqrt(1.0 - ratio**2) * per_speed * speed
    start = between.shape[nearest] * linear.scale
    x = start / np.linalg.norm(start)
    along = np.conj(x)
    for _ in range(ITERATIONS):
        value = complex(decay, per_speed * speed)
        sides = (matrices.by_eigenvalue(value, speed) @ x, matrices.by_speed(value, speed) @ x)
        try:
            by_value, by_speed = np.linalg.solve(matrices.at(value, speed), np.stack(sides, axis=1)).T
        except np.linalg.LinAlgError:
            return None
        share = along @ by_value
        columns = np.array([share, 1j * per_speed * share + along @ by_speed])
        both = np.array([columns.real, columns.imag])
        if abs(np.linalg.det(both)) == 0.0 or not np.all(np.isfinite(both)):
            return None
        change, shift = np.linalg.solve(both, [-1.0, 0.0])
        x = -(by_value * (change + 1j * per_speed * shift) + by_speed * shift)
        decay, speed = decay + float(change), speed + float(shift)
        if not low - (high - low) <= speed <= high + (high - low):
            return None
        if abs(complex(change, per_speed * shift)) <= CLOSE * abs(value):
            return _accepted_crossing(linear, matrices, between, x, complex(decay, per_speed * speed))
    return None


def _accepted_crossing(
    linear: LinearSystem, matrices: SpeedMatrices, between: _Between, x: ComplexArray, value: complex
) -> _Crossing | None:
    """Return the crossing if it is between the speeds and of the mode."""
    frequency = value.imag / (2.0 * math.pi)
    speed = frequency / between.rate
    low, high = between.speed
    room = CLOSE * max(abs(low), abs(high))
    shape = (x / linear.scale)[None, :]
    if not low - room <= speed <= high + room or likeness(linear, between.shape, shape).max() < ALIKE:
        return None
    force = matrices.at(value, speed) @ x
    slope = matrices.by_eigenvalue(value, speed) @ x
    left = float(np.linalg.norm(force) / np.linalg.norm(slope)) / (2.0 * math.pi)
    return _Crossing(speed, frequency, -value.real / abs(value), left)


def _halved_interval(system: System, linear: LinearSystem, between: _Between) -> _Between:
    """Return the half in which the gap changes its sign."""
    middle = float(np.mean(between.speed))
    modes = modes_at(system, linear, middle)
    which = int(np.argmax(likeness(linear, between.shape, modes.shape).max(axis=0)))
    frequency = float(modes.frequency[which])
    gap = frequency - between.rate * middle
    end = 0 if (gap > 0.0) == (between.gap[0] > 0.0) else 1

    def put(values: Any, value: Any) -> Any:
        changed = values.copy()
        changed[end] = value
        return changed

    return _Between(
        put(between.speed, middle),
        put(between.gap, gap),
        put(between.frequency, frequency),
        put(between.damping_ratio, modes.damping_ratio[which]),
        put(between.shape, modes.shape[which]),
        between.rate,
    )
