"""Campbell diagram: whirl modes over speed, each followed from speed to speed, with their sense of whirl."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from dynamics.assembly.assemble import System
from dynamics.bearings.seat import SEAT
from dynamics.linearize.linear_system import LinearSystem, kinetic_shares, linearize, strain_shares
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.spun_shaft import pair_rows, spun_inertia
from dynamics.motion.force_balance import block_diagonal, swept_by_frames
from dynamics.motion.observation import local_state, observe_laws
from dynamics.types import ComplexArray, FloatArray, IntArray

# Natural modes of a rotating system, with gyroscopic, Coriolis and centripetal terms.


QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # z x
LATERAL, TILT = (0, 1), (3, 4)
OSCILLATING = 1e-6  # least imaginary part over the largest eigenvalue's size
TIE = 0.05  # weight of the frequencies beside the shapes: it decides between modes of one shape's likeness
SAME = 1e-6  # of a frequency: nearer modes count as repeated
STILL = 0.1  # share of kinetic energy across the axis below which a mode has no whirl
INTERVALS, FINEST = 8, 32
"""Equal parts of a range of speeds over which modes are followed, and into how many it is divided at most."""
ALIKE = 0.9
"""Likeness of a mode and the one that continues it from which on nothing between them need be looked at."""


@dataclass(frozen=True)
class WhirlModes:
    """Modes that oscillate, by rising frequency, as seen in the frame of each shaft."""

    frequency: FloatArray
    """Damped, Hz. Shape (a,)."""
    damping_ratio: FloatArray
    """-Re/|eigenvalue|; below 0: unstable. Shape (a,)."""
    shape: ComplexArray
    """One mode per row, per freedom in m and rad; the largest entry in meters is 1. Shape (a, n)."""
    freedom: tuple[str, ...]
    """Names of the columns, "shaft.kind"."""
    scale: FloatArray
    """Meters per unit of each freedom. Shape (n,)."""


def whirl_modes(system: System, time: float = 0.0) -> WhirlModes:
    """Return the modes about the static equilibrium at the speeds of the kinematic motion at `time`.

    M x'' + (C + G) x' + (K + S) x = 0 with G and S of `speed_terms`, both zero at standstill.

    Raises
    ------
    SolveError
        If there is no static equilibrium.
    """
    return _whirl_modes_with(linearize(system, time), *speed_terms(system, time))


def _whirl_modes_with(linear: LinearSystem, gyroscopic: FloatArray, stiffening: FloatArray) -> WhirlModes:
    """Return the modes of `linear` with the terms G and S (n, n) of its speeds."""
    eigenvalue, vector = _eigen(linear, linear.damping + gyroscopic, linear.stiffness + stiffening)
    kept = np.flatnonzero(eigenvalue.imag > OSCILLATING * np.max(np.abs(eigenvalue), initial=0.0))
    kept = kept[np.argsort(eigenvalue[kept].imag)]
    shape = vector[: linear.scale.size, kept].T
    largest = np.take_along_axis(shape, np.argmax(np.abs(shape), axis=1)[:, None], axis=1)
    return WhirlModes(
        eigenvalue[kept].imag / (2.0 * math.pi),
        -eigenvalue[kept].real / np.abs(eigenvalue[kept]),
        shape / largest / linear.scale,
        linear.freedom,
        linear.scale,
    )


def speed_terms(system: System, time: float) -> tuple[FloatArray, FloatArray]:
    """Return G and S (n, n), factors of the rates and of the displacements, at the speeds at `time`.

    A shaft of spin w in a frame of speed W (0: fixed) feels, with J = z x,

        lateral:  m (2 W J u' - W^2 u),     tilt:  (2 I_t W - I_p w) J a' + (I_p w W - I_t W^2) a,

    and a ground damper c seen from the frame c W J u. Constant centripetal forces are left out: they move
    the equilibrium, not the modes.
    """
    return terms_at(system, observe_laws(system.arrays, np.array([time]))[2, :, 0])


def terms_at(system: System, law_speed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return G and S (n, n) of `speed_terms` at the speeds `law_speed` (k,) of the laws, rad/s."""
    speed = system.kinematics.float_ratio @ law_speed
    size = column_count(system.rotors)
    gyroscopic, stiffening = np.zeros((size, size)), np.zeros((size, size))
    for index, rotor in enumerate(system.rotors):
        frame = 0.0 if rotor.frame is None else float(speed[rotor.frame])
        inertia, spin = rotor.inertia, float(speed[index])
        for kinds, rate, rest in (
            (LATERAL, 2.0 * inertia.mass * frame, -inertia.mass * frame**2),
            (
                TILT,
                2.0 * inertia.transverse * frame - inertia.polar * spin,
                (inertia.polar * spin - inertia.transverse * frame) * frame,
            ),
        ):
            block = np.ix_([6 * index + k for k in kinds], [6 * index + k for k in kinds])
            gyroscopic[block] += rate * QUARTER_TURN
            stiffening[block] += rest * np.eye(2)
    supports = system.supports
    for bearing, carrier in enumerate(supports.frame):
        if carrier is not None:
            moves = supports.motion[bearing, :2]
            damping = supports.damping[bearing, 0] * float(speed[carrier])
            stiffening += damping * moves.T @ QUARTER_TURN @ moves
    seats = system.seats
    if any(carrier is not None for carrier in seats.frame):
        of_frame = [0.0 if carrier is None else float(speed[carrier]) for carrier in seats.frame]
        stiffening += seats.motion.T @ (seats.turned_damping * np.repeat(of_frame, SEAT)) @ seats.motion
    for index, rotor in enumerate(system.rotors):
        if rotor.elastic is not None and rotor.elastic.bends:
            gyroscopic += _along_the_shaft(system, index, float(speed[index]))
    motion = system.freedoms.motion
    return motion.T @ gyroscopic @ motion, motion.T @ stiffening @ motion + _across_frames(system, law_speed)


def _across_frames(system: System, law_speed: FloatArray) -> FloatArray:
    """Return what dampers across frames add to the stiffness, (n, n), at the frames' angles at t = 0."""
    arrays, rest = system.arrays, np.zeros(system.arrays.mass.shape[0])
    local, pace = local_state(arrays, 0.0, rest, rest), arrays.reference.per_radian @ law_speed
    swept = block_diagonal(arrays.elements, swept_by_frames(arrays.elements, local, pace))
    return np.asarray(arrays.direction.T @ swept @ arrays.direction)


def _along_the_shaft(system: System, index: int, spin: float) -> FloatArray:
    """Gyroscopic terms of a shaft that bends, beyond those of its tilt as a rigid body, (N, N)."""
    rows, inertia = pair_rows(system.rotors, index), spun_inertia(system.rotors[index])
    inertia[0, 0] = 0.0
    across = QUARTER_TURN @ np.tensordot(inertia, rows, axes=1)
    return np.asarray(-spin * np.tensordot(rows, across, axes=((0, 1), (0, 1))))


def _eigen(
    linear: LinearSystem, damping: FloatArray, stiffness: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Eigenvalues and vectors of the first-order system, freedoms in meters."""
    per_meter, n = 1.0 / linear.scale, linear.scale.size
    mass, damping, stiffness = (per_meter[:, None] * a * per_meter for a in (linear.mass, damping, stiffness))
    state = np.zeros((2 * n, 2 * n))
    state[:n, n:] = np.eye(n)
    state[n:, :n], state[n:, n:] = -np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)
    values, vectors = np.linalg.eig(state)
    return values.astype(complex), vectors.astype(complex)


@dataclass(frozen=True)
class WhirlBranches:
    """A modes over S speeds, n freedoms, p springs; NaN where a mode does not oscillate."""

    speed: FloatArray
    """Of the leading law, rad/s. Shape (S,)."""
    frequency: FloatArray
    damping_ratio: FloatArray
    """`frequency`, `damping_ratio`: Damped, Hz; -Re/|eigenvalue|. Shape (S, A) each."""
    whirl: FloatArray
    """Of the shaft that moves most across its axis: from -1 (circular, against its rotation) over 0 (in a
    plane, or no shaft moves much, or it is at rest) to +1 (circular, in the sense of its rotation). Shape (S,
    A).
    """
    shape: ComplexArray
    """The largest entry in meters is 1. Shape (S, A, n)."""
    strain_energy: FloatArray
    kinetic_energy: FloatArray
    """`strain_energy`, `kinetic_energy`: Shares, mean over a cycle. (S, A, p), (S, A, n) arrays."""


def modes_at(system: System, linear: LinearSystem, speed: float) -> WhirlModes:
    """Return the whirl modes where the leading law has `speed` in rad/s."""
    return _whirl_modes_with(linear, *terms_at(system, law_speeds(system, speed)))


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
    return _followed(system, linear, speed, swept)


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
    return _followed(system, linear, grid[chosen], [swept[index] for index in chosen])


def _clear(linear: LinearSystem, before: WhirlModes, modes: WhirlModes) -> bool:
    """Whether every mode continues in one like it; repeated ones, as of two planes, count together."""
    if before.frequency.size != modes.frequency.size:
        return False
    alike, rows, columns = _assigned(linear, before, modes)
    first, second = (_repeated(each.frequency) for each in (before, modes))
    together = np.maximum(first @ alike, alike @ second)
    return bool(np.min(together[rows, columns], initial=1.0) >= ALIKE)


def _repeated(frequency: FloatArray) -> FloatArray:
    """Return which modes are the same but for their shapes, (a, a): 1 or 0."""
    return np.asarray(np.abs(frequency[:, None] - frequency) <= SAME * frequency, dtype=float)


def _followed(
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
    apart = np.abs(before.frequency[:, None] - modes.frequency)
    apart = apart / (before.frequency[:, None] + modes.frequency)
    alike = likeness(linear, before.shape, modes.shape)
    rows, columns = scipy.optimize.linear_sum_assignment(TIE * apart - alike)
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


def whirl_sense(system: System, linear: LinearSystem, speed: float, modes: WhirlModes) -> FloatArray:
    """Return the sense of whirl of each mode, (a,).

    Modes of one frequency are any combination of each other: they get one sense together, which does not
    depend on the combination.
    """
    spin = system.kinematics.float_ratio @ law_speeds(system, speed)
    frequency, basis = modes.frequency, modes.shape.copy()
    ends = np.flatnonzero(np.diff(frequency) > SAME * frequency[1:]) + 1
    clusters = [part for part in np.split(np.arange(frequency.size), ends) if part.size]
    for cluster in clusters:
        if cluster.size > 1:  # shapes of the same span that the mass makes orthonormal
            factor = np.linalg.cholesky(linear.mass)
            spanned = np.linalg.qr(factor.T @ basis[cluster].T)[0]
            basis[cluster] = np.linalg.solve(factor.T, spanned).T
    sense = _senses(system, spin, basis, kinetic_shares(linear, basis), clusters)
    return np.repeat(sense, [cluster.size for cluster in clusters])


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
