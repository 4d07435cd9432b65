"""Campbell diagram: whirl modes over speed, each followed from speed to speed, with their sense of whirl.

Whirl is the motion of a shaft's axis around its position of rest. A branch is one mode over all speeds. The
leading law is the first drive or free rotation that turns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize.linear_system import LinearSystem
from dynamics.linearize.mode_energy import kinetic_shares, strain_shares
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.linearize.whirl_modes import SAME, WhirlModes, terms_at, whirl_modes_with, whirl_sense
from dynamics.types import ComplexArray, FloatArray, IntArray
from host.optional_modules import scipy

TIE = 0.05  # weight of frequencies against shapes: it decides between modes of equal shape
INTERVALS, FINEST = 8, 32
"""Number of equal parts of a range of speeds over which modes are followed, and most parts of each of them.
"""
ALIKE = 0.9
"""Likeness of a mode and its continuation, from which on no speed between them is needed."""


@dataclass(frozen=True)
class WhirlBranches:
    """A modes over S speeds, n freedoms, p springs; NaN where a mode does not oscillate."""

    speed: FloatArray
    """Speeds of the leading law, rad/s. Shape (S,)."""
    frequency: FloatArray
    damping_ratio: FloatArray
    """`frequency`, `damping_ratio`: Damped natural frequency, Hz, and damping ratio -Re/|eigenvalue|. Shape
    (S, A) each.
    """
    whirl: FloatArray
    """Whirl of the shaft that moves most across its axis: from -1 (circular, against its rotation) over 0 (in
    a plane, or no shaft moves much, or it is at rest) to +1 (circular, in the sense of its rotation). Shape
    (S, A).
    """
    shape: ComplexArray
    """Mode shapes, whose largest entry in meters is 1. Shape (S, A, n)."""
    strain_energy: FloatArray
    kinetic_energy: FloatArray
    """`strain_energy`, `kinetic_energy`: Shares of springs and freedoms in the energies of a mode, mean over
    a cycle. (S, A, p), (S, A, n) arrays.
    """


def modes_at(system: System, linear: LinearSystem, speed: float) -> WhirlModes:
    """Return the whirl modes where the leading law has `speed` in rad/s."""
    return whirl_modes_with(linear, *terms_at(system, law_speeds(system, speed)))


def whirl_branches(
    system: System,
    linear: LinearSystem,
    speed: FloatArray,
    progress: Callable[[float], None] | None = None,
) -> WhirlBranches:
    """Return the modes at the speeds (S,), rad/s, sorted by frequency at the first and followed from there.

    A mode continues in the one whose shape is most like it (modal assurance criterion weighted with the
    mass), all assigned together; equal likeness is decided by the nearness of the frequencies.
    """
    swept: list[WhirlModes] = []
    for index, value in enumerate(speed):
        swept.append(modes_at(system, linear, float(value)))
        if progress is not None:
            progress((index + 1) / speed.size)
    return _followed_branches(system, linear, speed, swept)


def branches_up_to(system: System, linear: LinearSystem, highest: float) -> WhirlBranches:
    """Return the branches from rest up to a speed, rad/s, at as many speeds as following them takes.

    An eighth of the range is halved, down to 1/32, unless each mode at its end is like the one that it
    continues.
    """
    grid = np.linspace(0.0, highest, FINEST + 1)
    ends = range(0, FINEST + 1, FINEST // INTERVALS)
    swept = {index: modes_at(system, linear, float(grid[index])) for index in ends}
    parts = list(pairwise(ends))
    while parts:
        low, high = parts.pop()
        if high - low == 1 or _clear(linear, swept[low], swept[high]):
            continue
        middle = (low + high) // 2
        swept[middle] = modes_at(system, linear, float(grid[middle]))
        parts += [(low, middle), (middle, high)]
    chosen = sorted(swept)
    return _followed_branches(system, linear, grid[chosen], [swept[index] for index in chosen])


def _clear(linear: LinearSystem, before: WhirlModes, modes: WhirlModes) -> bool:
    """Whether every mode continues in one like it; repeated ones, as of two planes, count together."""
    if before.frequency.size != modes.frequency.size:
        return False
    alike, rows, columns = _assigned(linear, before, modes)
    first, second = (_repeated(branch_modes.frequency) for branch_modes in (before, modes))
    together = np.maximum(first @ alike, alike @ second)
    return bool(np.min(together[rows, columns], initial=1.0) >= ALIKE)


def _repeated(frequency: FloatArray) -> FloatArray:
    """Return the pairs of modes that differ in their shapes alone, (a, a): 1 or 0."""
    return np.asarray(np.abs(frequency[:, None] - frequency) <= SAME * frequency, dtype=float)


def _followed_branches(
    system: System, linear: LinearSystem, speed: FloatArray, swept: Sequence[WhirlModes]
) -> WhirlBranches:
    """Return the branches of the modes `swept` at the speeds (S,)."""
    branches: list[list[int]] = []
    for index, modes in enumerate(swept):
        fresh = list(range(modes.frequency.size))
        branches.append(continued_branches(linear, swept[index - 1], branches[-1], modes) if index else fresh)
    count = 1 + max((int(np.max(branch, initial=-1)) for branch in branches), default=-1)
    n, p = linear.scale.size, len(linear.spring)
    frequency, ratio, whirl = (np.full((speed.size, count), np.nan) for _ in range(3))
    shape = np.full((speed.size, count, n), np.nan + 0j)
    strain, kinetic = np.full((speed.size, count, p), np.nan), np.full((speed.size, count, n), np.nan)
    for row, (modes, branch) in enumerate(zip(swept, branches, strict=True)):
        frequency[row, branch], ratio[row, branch] = modes.frequency, modes.damping_ratio
        shape[row, branch] = modes.shape
        strain[row, branch] = strain_shares(linear, modes.shape)
        kinetic[row, branch] = kinetic_shares(linear, modes.shape)
        whirl[row, branch] = whirl_sense(system, linear, float(speed[row]), modes)
    return WhirlBranches(speed, frequency, ratio, whirl, shape, strain, kinetic)


def likeness(linear: LinearSystem, first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Modal assurance criterion of shapes (a, n) and (b, n), weighted with the mass, (a, b) in 0 to 1."""
    product = np.abs(np.conj(first) @ linear.mass @ second.T) ** 2
    size = [np.real(np.sum(np.conj(s) * (s @ linear.mass), axis=1)) for s in (first, second)]
    return np.asarray(product / (size[0][:, None] * size[1]))


def _assigned(
    linear: LinearSystem, before: WhirlModes, modes: WhirlModes
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return the likeness of modes (a, b), and which of the first continues in which of the second."""
    distance = np.abs(before.frequency[:, None] - modes.frequency)
    distance = distance / (before.frequency[:, None] + modes.frequency)
    alike = likeness(linear, before.shape, modes.shape)
    rows, columns = scipy.optimize.linear_sum_assignment(TIE * distance - alike)
    return alike, rows, columns


def continued_branches(
    linear: LinearSystem, before: WhirlModes, branch: list[int], modes: WhirlModes
) -> list[int]:
    """Return the branch of each mode: that of its predecessor, or a new one."""
    _, rows, columns = _assigned(linear, before, modes)
    known = dict(zip(columns.tolist(), (branch[row] for row in rows), strict=True))
    fresh = max(branch, default=-1)
    numbers = []
    for index in range(modes.frequency.size):
        if index not in known:
            fresh += 1
        numbers.append(known.get(index, fresh))
    return numbers
