"""Natural modes of a rotating system, with gyroscopic, Coriolis and centripetal terms."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.bearings.seat import SEAT
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.mode_energy import kinetic_shares
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.spun_shaft import pair_rows, spun_inertia
from dynamics.motion.force_balance import block_diagonal, swept_by_frames
from dynamics.motion.observation import local_state, observe_laws
from dynamics.types import ComplexArray, FloatArray, IntArray

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # J: turns a vector (x, y) by 90 degrees about +z


LATERAL, TILT = (0, 1), (3, 4)  # indices among the freedoms of a rotor: x and y, tilt_x and tilt_y


OSCILLATING = 1e-6  # least imaginary part over the largest eigenvalue's size


STILL = 0.1  # share of kinetic energy across the axis below which a mode has no whirl
SAME = 1e-6  # relative difference of frequencies, below which modes count as repeated


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
    return whirl_modes_with(linearize(system, time), *speed_terms(system, time))


def whirl_modes_with(linear: LinearSystem, gyroscopic: FloatArray, stiffening: FloatArray) -> WhirlModes:
    """Return the modes of `linear` with the terms G and S (n, n) of its speeds."""
    eigenvalue, vector = _eigen(linear, linear.damping + gyroscopic, linear.stiffness + stiffening)
    oscillating = np.flatnonzero(eigenvalue.imag > OSCILLATING * np.max(np.abs(eigenvalue), initial=0.0))
    oscillating = oscillating[np.argsort(eigenvalue[oscillating].imag)]
    shape = vector[: linear.scale.size, oscillating].T
    largest = np.take_along_axis(shape, np.argmax(np.abs(shape), axis=1)[:, None], axis=1)
    return WhirlModes(
        eigenvalue[oscillating].imag / (2.0 * math.pi),
        -eigenvalue[oscillating].real / np.abs(eigenvalue[oscillating]),
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
    _, _, law_speed, _ = observe_laws(system.arrays, np.array([time]))  # (laws, 1) each
    return terms_at(system, law_speed[:, 0])


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
        frame_speed = [0.0 if carrier is None else float(speed[carrier]) for carrier in seats.frame]
        column_speed = np.repeat(frame_speed, SEAT)  # (5 s,): each seat has `SEAT` columns
        stiffening += seats.motion.T @ (seats.turned_damping * column_speed) @ seats.motion
    for index, rotor in enumerate(system.rotors):
        if rotor.elastic is not None and rotor.elastic.bends:
            gyroscopic += _along_the_shaft(system, index, float(speed[index]))
    motion = system.freedoms.motion
    return motion.T @ gyroscopic @ motion, motion.T @ stiffening @ motion + _across_frames(system, law_speed)


def _across_frames(system: System, law_speed: FloatArray) -> FloatArray:
    """Return the stiffness (n, n) by dampers across frames, at the frames' angles at t = 0."""
    arrays = system.arrays
    zero = np.zeros(arrays.mass.shape[0])
    local = local_state(arrays, time=0.0, q=zero, v=zero)
    pace = arrays.reference.per_radian @ law_speed  # base pitches of meshes and turns of frames per second
    swept = block_diagonal(arrays.elements, swept_by_frames(arrays.elements, local, pace))
    return np.asarray(arrays.direction.T @ swept @ arrays.direction)


def _along_the_shaft(system: System, index: int, spin: float) -> FloatArray:
    """Gyroscopic terms of a shaft that bends, beyond those of its tilt as a rigid body, (N, N)."""
    rows, inertia = pair_rows(system.rotors, index), spun_inertia(system.rotors[index])
    inertia[0, 0] = 0.0  # the tilt as a rigid body, which `terms_at` has counted
    across = QUARTER_TURN @ np.tensordot(inertia, rows, axes=1)  # (1 + b, 2, N)
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
        for kinds in (LATERAL, TILT)
    ]
    # rotor, and columns of its motions about x and y; a freedom that is not computed has column -1
    pairs = np.array([pair for pair in candidates if min(pair[1:]) >= 0], dtype=np.int64).reshape(-1, 3)
    if pairs.size == 0 or not clusters:
        return np.zeros(len(clusters))
    rotor, i, j = pairs.T
    first = [cluster[0] for cluster in clusters]
    turned, size, share = (
        np.add.reduceat(values, first, axis=0)
        for values in (
            np.imag(shape[:, i] * np.conj(shape[:, j])),
            np.abs(shape[:, i]) ** 2 + np.abs(shape[:, j]) ** 2,
            kinetic[:, i] + kinetic[:, j],
        )
    )
    row, maximum = np.arange(len(clusters)), np.argmax(share, axis=1)
    moves = share[row, maximum] > STILL * np.array([cluster.size for cluster in clusters])
    circling = turned[row, maximum] / np.where(moves, size[row, maximum], 1.0)
    return np.asarray(np.where(moves, np.sign(spin[rotor[maximum]]) * 2.0 * circling, 0.0))
