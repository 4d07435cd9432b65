"""Campbell diagram: whirl modes over speed, each followed from speed to speed, with their sense of whirl."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from dynamics.assembly.assemble import System
from dynamics.linearize.energy_shares import kinetic_shares, strain_shares
from dynamics.linearize.linear_system import LinearSystem
from dynamics.linearize.speeds import law_speeds
from dynamics.linearize.whirl import ComplexArray, WhirlModes, terms_at, whirl_modes_with
from dynamics.types import FloatArray, IntArray

TIE = 0.05  # weight of the frequencies beside the shapes: it decides between modes of one shape's likeness
SAME = 1e-6  # of a frequency: nearer modes count as repeated
STILL = 0.1  # share of kinetic energy across the axis below which a mode has no whirl


@dataclass(frozen=True)
class WhirlBranches:
    """A modes over S speeds, n freedoms, p springs; NaN where a mode does not oscillate.

    Attributes
    ----------
    speed : (S,) array
        Of the leading law, rad/s.
    frequency, damping_ratio : (S, A) arrays
        Damped, Hz; -Re/|eigenvalue|.
    whirl : (S, A) array
        Of the shaft that moves most across its axis: from -1 (circular, against its rotation) over 0 (in a
        plane, or no shaft moves much, or it is at rest) to +1 (circular, in the sense of its rotation).
    shape : (S, A, n) complex array
        The largest entry in meters is 1.
    strain_energy, kinetic_energy : (S, A, p), (S, A, n) arrays
        Shares, mean over a cycle.
    """

    speed: FloatArray
    frequency: FloatArray
    damping_ratio: FloatArray
    whirl: FloatArray
    shape: ComplexArray
    strain_energy: FloatArray
    kinetic_energy: FloatArray


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
    branches: list[list[int]] = []
    for index, value in enumerate(speed):
        modes = modes_at(system, linear, float(value))
        swept.append(modes)
        fresh = list(range(modes.frequency.size))
        branches.append(_continued(linear, swept[-2], branches[-1], modes) if index else fresh)
        if progress is not None:
            progress((index + 1) / speed.size)
    count = 1 + max((int(np.max(branch, initial=-1)) for branch in branches), default=-1)
    return _gathered(system, linear, speed, swept, branches, count)


def likeness(linear: LinearSystem, first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Modal assurance criterion of shapes (a, n) and (b, n), weighted with the mass, (a, b) in 0 to 1."""
    product = np.abs(np.conj(first) @ linear.mass @ second.T) ** 2
    size = [np.real(np.sum(np.conj(s) * (s @ linear.mass), axis=1)) for s in (first, second)]
    return np.asarray(product / (size[0][:, None] * size[1]))


def _continued(linear: LinearSystem, before: WhirlModes, branch: list[int], modes: WhirlModes) -> list[int]:
    """Return the branch of each mode: that of its predecessor, or a new one."""
    apart = np.abs(before.frequency[:, None] - modes.frequency)
    apart = apart / (before.frequency[:, None] + modes.frequency)
    rows, columns = linear_sum_assignment(TIE * apart - likeness(linear, before.shape, modes.shape))
    known = dict(zip(columns.tolist(), (branch[row] for row in rows), strict=True))
    fresh = max(branch, default=-1)
    numbers = []
    for index in range(modes.frequency.size):
        if index not in known:
            fresh += 1
        numbers.append(known.get(index, fresh))
    return numbers


def _gathered(
    system: System,
    linear: LinearSystem,
    speed: FloatArray,
    swept: list[WhirlModes],
    branches: list[list[int]],
    count: int,
) -> WhirlBranches:
    """Put the branches together."""
    n, p = linear.scale.size, len(linear.spring)
    frequency, ratio, whirl = (np.full((speed.size, count), np.nan) for _ in range(3))
    shape = np.full((speed.size, count, n), np.nan + 0j)
    strain, kinetic = np.full((speed.size, count, p), np.nan), np.full((speed.size, count, n), np.nan)
    for row, (modes, branch) in enumerate(zip(swept, branches, strict=True)):
        frequency[row, branch], ratio[row, branch] = modes.frequency, modes.damping_ratio
        shape[row, branch] = modes.shape
        strain[row, branch] = strain_shares(linear, modes.shape)
        kinetic[row, branch] = kinetic_shares(linear, modes.shape)
        whirl[row, branch] = _whirl(system, linear, float(speed[row]), modes)
    return WhirlBranches(speed, frequency, ratio, whirl, shape, strain, kinetic)


def _whirl(system: System, linear: LinearSystem, speed: float, modes: WhirlModes) -> FloatArray:
    """Return the sense of whirl of each mode, (a,).

    Modes of one frequency are any combination of each other: they get one sense together, which does not
    depend on the combination.
    """
    spin = system.kinematics.float_ratio @ law_speeds(system, speed)
    clusters, basis = _clusters(modes.frequency), modes.shape.copy()
    for cluster in clusters:
        if cluster.size > 1:
            basis[cluster] = _orthonormal(linear, basis[cluster])
    sense = _senses(system, spin, basis, kinetic_shares(linear, basis), clusters)
    return np.repeat(sense, [cluster.size for cluster in clusters])


def _clusters(frequency: FloatArray) -> list[IntArray]:
    """Group modes, sorted by frequency, whose neighbors are alike."""
    ends = np.flatnonzero(np.diff(frequency) > SAME * frequency[1:]) + 1
    return [part for part in np.split(np.arange(frequency.size), ends) if part.size]


def _orthonormal(linear: LinearSystem, shape: ComplexArray) -> ComplexArray:
    """Return shapes (c, n) of the same span that the mass makes orthonormal."""
    factor = np.linalg.cholesky(linear.mass)
    return np.asarray(np.linalg.solve(factor.T, np.linalg.qr(factor.T @ shape.T)[0]).T)


def _senses(
    system: System, spin: FloatArray, shape: ComplexArray, kinetic: FloatArray, clusters: list[IntArray]
) -> FloatArray:
    """Return the sense in which the shaft that moves most across its axis goes round in each cluster.

    Sums over its modes: traces, which are the same in every orthonormal basis.
    """
    candidates = [
        (rotor, *(system.freedoms.find(rotor, kind) for kind in kinds))
        for rotor in range(len(system.rotors))
        for kinds in ((0, 1), (3, 4))
    ]
    pairs = np.array([each for each in candidates if min(each[1:]) >= 0], dtype=np.int64).reshape(-1, 3)
    if pairs.size == 0 or not clusters:
        return np.zeros(len(clusters))
    (rotor, i, j), first = pairs.T, [cluster[0] for cluster in clusters]
    turned, size, share = (
        np.add.reduceat(values, first, axis=0)
        for values in (
            np.imag(shape[:, i] * np.conj(shape[:, j])),
            np.abs(shape[:, i]) ** 2 + np.abs(shape[:, j]) ** 2,
            kinetic[:, i] + kinetic[:, j],
        )
    )
    row, most = np.arange(len(clusters)), np.argmax(share, axis=1)
    moves = share[row, most] > STILL * np.array([cluster.size for cluster in clusters])
    circling = turned[row, most] / np.where(moves, size[row, most], 1.0)
    return np.asarray(np.where(moves, np.sign(spin[rotor[most]]) * 2.0 * circling, 0.0))
