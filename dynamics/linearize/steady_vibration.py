"""Steady vibration about the static equilibrium: its excitation, and the displacements at every harmonic.

Harmonics are multiples of the frequency of the common period, after which all meshes and loads are in phase
again. Axes of arrays: S speeds, H harmonics, n freedoms, R' rows (local coordinates) of the driving flanks, m
meshes, f rows along which a unit force acts. A *receptance* is a displacement per force. *Swept* matrices are
gyroscopic and frame terms, which change with the speed. A mesh excites in one of two ways: by its *static
error*, an imposed STE, or by its *blocked force*, that of flanks whose transmission error stays at its mean.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.laws import Law
from dynamics.kernels.local_state import LocalState
from dynamics.linearize.common_period import CommonPeriod, common_period
from dynamics.linearize.flank_cycles import SAMPLES, FlankCycle, averaged, flank_cycles, resting
from dynamics.linearize.linear_system import LinearSystem, about_running, linearize
from dynamics.linearize.load_harmonics import load_harmonics
from dynamics.linearize.modal_elimination import modal_elimination, solved, turning_terms
from dynamics.linearize.natural_modes import unbounded
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.linearize.partial_fractions import PRECISE, PartialFractions
from dynamics.linearize.whirl_modes import terms_at
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray

Terms = tuple[FloatArray, FloatArray]
"""Gyroscopic and frame terms of the damping and of the stiffness at one speed, (n, n) each."""
EXCITATIONS = ("static_error", "blocked_force")
BLOCK = 1_000_000  # entries of the matrices that are solved at once
NOTHING = 1e-12  # force over the largest exciting force, below which harmonics are left out
ROUNDED = 1e-3
"""Largest rounding of the elastic forces, over the exciting force, at which a solution is accepted."""
SWEPT = 0.34
"""Rate of decay (1/s) that limits a resonance as a sweep does, over the root of the rate of the circular
frequency (rad/s^2). An undamped oscillator of mass m that is swept at the rate h through its frequency w
reaches at most the amplitude 1.17 sqrt(2 pi/h)/(2 m w) per force (Lewis, 1932)."""


@dataclass(frozen=True)
class Excited:
    """A system about its equilibrium under the loads at a time, and the cycles of its flanks."""

    system: System
    time: float
    """Time at which the loads are taken, s."""
    period: CommonPeriod
    linear: LinearSystem
    """Linear system with the mean tangents of the flanks."""
    at_rest: LocalState
    """State of the force elements at the equilibrium."""
    cycles: tuple[FlankCycle, ...]
    turning: bool = False
    """Whether rotating-frame elements act: gyroscopic and frame terms belong to the system."""


@dataclass(frozen=True)
class Steady:
    """Displacements of n freedoms at S speeds in H harmonics of the common period."""

    harmonics: IntArray
    """Multiples of the common period's frequency. Shape (H,)."""
    omega: FloatArray
    """Circular frequencies, rad/s. Shape (S, H)."""
    static: ComplexArray
    """Static transmission errors, m. Shape (m, H)."""
    force: ComplexArray
    """Exciting forces on the rows of the driving flanks, N. Shape (1 or S, R', H)."""
    displacement: ComplexArray
    """Displacements, m and rad. Shape (S, H, n)."""
    residual: float
    """Largest force left by the linear solves, over the largest exciting force."""
    receptance: ComplexArray
    """Displacements per force along f rows; f = 0 where not requested. The rows of `swept_vibration` are
    those of the driving flanks. Shape (S, H, n, f).
    """


def excited(system: System, time: float = 0.0, orders: int = 10, samples: int = SAMPLES) -> Excited:
    """Linearize `system` under the loads at `time`, with flanks at up to `samples` positions per base pitch.

    Raises
    ------
    InputError
        If the meshes have no common period.
    SolveError
        If there is no static equilibrium.
    """
    system = about_running(system)
    period, linear = common_period(system), linearize(system, time)
    at_rest = resting(system, linear, time)
    cycles = flank_cycles(system, linear, at_rest, orders, samples)
    turning = bool(np.any(system.arrays.elements.law == Law.ROTATING_FRAME))
    linear = averaged(system, linear, cycles, at_rest)
    return Excited(system, time, period, linear, at_rest, cycles, turning)


def steady_vibration(
    at: Excited,
    speed: FloatArray,
    harmonics: IntArray,
    excitation: str = "static_error",
    progress: Callable[[float], None] | None = None,
) -> Steady:
    """Return the vibration at `speed` (S,) in those of `harmonics` (H,) that are excited."""
    harmonics = excited_harmonics(at, speed, harmonics, (excitation,))
    return _vibration(at, speed, harmonics, excitation, progress=progress)[0]


def excited_harmonics(
    at: Excited, speed: FloatArray, harmonics: IntArray, excitations: Sequence[str] = EXCITATIONS
) -> IntArray:
    """Return the harmonics (H,) that at least one of `excitations`, or a load, reaches."""
    loads = load_harmonics(at.system, at.period, speed, harmonics, at.time)
    excited_lines = _is_excited(np.moveaxis(loads / at.linear.scale, 1, 2))
    for excitation in excitations:
        _, force = flank_forces(at, harmonics, excitation)
        excited_lines = excited_lines | _is_excited(force)
    return harmonics[excited_lines]


def with_blocked(
    at: Excited, speed: FloatArray, harmonics: IntArray, rows: FloatArray
) -> tuple[Steady, FloatArray]:
    """Return the vibration with the receptances of `rows` (f, n), and the response to the blocked forces.

    The response is the largest dynamic transmission error over the speeds, (m, H) in m.
    """
    return _vibration(at, speed, harmonics, EXCITATIONS[0], rows, second=EXCITATIONS[1])


def _is_excited(force: ComplexArray) -> BoolArray:
    """Return whether each of H harmonics is excited, by forces (..., H)."""
    largest = np.max(np.abs(force), axis=tuple(range(force.ndim - 1)), initial=0.0)
    return np.asarray(~(largest <= NOTHING * np.max(largest, initial=0.0)))  # NaN counts as excited


def _pushed(at: Excited, force: ComplexArray) -> ComplexArray:
    """Return the generalized forces (1, H, n) by forces on the driving flanks' rows, (R', H)."""
    return np.asarray(force.T @ at.system.arrays.direction[: force.shape[0]])[None]


def swept_vibration(
    at: Excited, speed: FloatArray, rate: FloatArray, harmonics: IntArray, gyroscopic: bool = False
) -> Steady:
    """Return the vibration at `speed` (S,) with the receptances of the meshes, all `harmonics` (H,).

    Where the speed changes at a `rate` (S,), rad/s^2, resonances are as high as they can grow while they are
    passed: damping is added (`SWEPT`). `gyroscopic` includes gyroscopic and frame terms.
    """
    static, force = flank_forces(at, harmonics, "static_error")
    loads = load_harmonics(at.system, at.period, speed, harmonics, at.time)
    pushed = _pushed(at, force) + loads if np.any(loads) else _pushed(at, force)
    omega = _omega(at, speed, harmonics)
    decay = SWEPT * np.sqrt(omega * (np.abs(rate) / np.abs(speed))[:, None])
    rows = at.system.arrays.direction[: len(force)]
    terms = gyroscopic_terms(at.system, speed) if gyroscopic else []
    u, residual, _ = _solve(at, pushed, omega - 1j * decay, terms, rows, fractions=True)
    return Steady(harmonics, omega, static, force[None], u[..., 0], residual, u[..., 1:])


def with_receptances(at: Excited, speed: FloatArray, harmonics: IntArray, rows: FloatArray) -> Steady:
    """Return the vibration at `speed` (S,) in all `harmonics` (H,), with the receptances of `rows` (f, n)."""
    return _vibration(at, speed, harmonics, EXCITATIONS[0], rows)[0]


def _vibration(
    at: Excited,
    speed: FloatArray,
    harmonics: IntArray,
    excitation: str,
    rows: FloatArray | None = None,
    second: str = "",
    progress: Callable[[float], None] | None = None,
) -> tuple[Steady, FloatArray]:
    """Return the vibration in all `harmonics`, and the largest response (m, H) to the `second` excitation."""
    static, force = flank_forces(at, harmonics, excitation)
    loads = load_harmonics(at.system, at.period, speed, harmonics, at.time)
    other = _pushed(at, flank_forces(at, harmonics, second)[1]) + loads if second else None
    omega = _omega(at, speed, harmonics)
    terms = gyroscopic_terms(at.system, speed) if at.turning else []
    u, residual, largest = _solve(at, _pushed(at, force) + loads, omega, terms, rows, other, progress)
    return Steady(harmonics, omega, static, force[None], u[..., 0], residual, u[..., 1:]), largest


def receptances(at: Excited, omega: FloatArray, rows: FloatArray) -> ComplexArray:
    """Return the displacements (G, 1, n, f) per force along each of `rows` (f, n) at `omega` (G,), rad/s.

    They hold at every speed if no frame rotates.
    """
    # the exciting force is needed only as the measure of the residual
    combined = np.sum(rows, axis=0, dtype=complex)[None, None]
    return _solve(at, combined, omega[:, None], rows=rows)[0][..., 1:]


def speed_blocks(shape: tuple[int, ...], entries: int) -> list[slice]:
    """Return slices of the S speeds of `shape` (S, H) so that a slice has at most `BLOCK` entries.

    `entries` is the number of entries for one speed and harmonic.
    """
    block = max(BLOCK // max(shape[1] * entries, 1), 1)
    return [slice(start, start + block) for start in range(0, shape[0], block)]


def _omega(at: Excited, speed: FloatArray, harmonics: IntArray) -> FloatArray:
    """Return the circular frequencies (S, H), rad/s."""
    duration = np.array([[at.period.duration(w)] for w in speed])
    return np.asarray(2.0 * math.pi * harmonics / duration)


def gyroscopic_terms(system: System, speed: FloatArray) -> list[Terms]:
    """Return the gyroscopic and frame terms (n, n) of damping and stiffness at each leading `speed`.

    They are proportional to the speed, centripetal ones to its square, so that two speeds determine them.
    """
    part = np.abs(speed) / np.max(np.abs(speed))
    gyroscopic, once = terms_at(system, law_speeds(system, float(np.max(np.abs(speed)))))
    _, twice = terms_at(system, law_speeds(system, 2.0 * float(np.max(np.abs(speed)))))
    # once = linear + centripetal, twice = 2 linear + 4 centripetal
    linear, centripetal = 2.0 * once - 0.5 * twice, 0.5 * twice - once
    return [(w * gyroscopic, w * linear + w * w * centripetal) for w in part]


def flank_forces(
    at: Excited, harmonics: IntArray, kind: str = "static_error"
) -> tuple[ComplexArray, ComplexArray]:
    """Return the STE (m, H) and the exciting force on the rows of the driving flanks (R', H).

    A positive force increases the deflection d, as a positive STE does. Other forces of a flank (friction,
    the moment of a load that moves along the face) excite too where they vary at constant mesh force.
    """
    cycles = at.cycles
    static = np.zeros((len(cycles), harmonics.size), dtype=complex)
    force = np.zeros((cycles[-1].rows.stop if cycles else 0, harmonics.size), dtype=complex)
    for f, cycle in enumerate(cycles):
        static[f] = harmonics_of(at, f, cycle.static_error, harmonics)
        for p, row in enumerate(range(cycle.rows.start, cycle.rows.stop)):
            if kind == "static_error":
                # the first row is that of the mesh force, which is constant in the static error
                preload = harmonics_of(at, f, cycle.force[:, p], harmonics) if p else 0.0
                force[row] = cycle.tangent[p, 0] * static[f] - preload
            else:
                force[row] = -harmonics_of(at, f, cycle.blocked[:, p], harmonics)
    return static, force


def harmonics_of(at: Excited, index: int, values: FloatArray, harmonics: IntArray) -> ComplexArray:
    """Return the amplitudes (H,) of values (T,) over the table of a mesh, at harmonics of the common period.

    They are zero for harmonics that are no multiples of the frequency at which the table repeats.
    """
    mesh, pitches = at.system.scene.meshes[index], at.period.pitches[index]
    period, offset = mesh.table.period, float(at.system.phases.position[index])
    lines = 2.0 * np.fft.rfft(values) / values.size
    amplitudes = np.zeros(harmonics.size, dtype=complex)
    cycles = abs(pitches) // period  # of the table in the common period; 0: the mesh is at rest
    if cycles == 0:
        return amplitudes
    line, rest = np.divmod(harmonics, cycles)
    present = (rest == 0) & (line < lines.size - 1)  # without the line at half the sampling rate
    rotated = lines[line[present]] * np.exp(2j * math.pi * line[present] * offset / period)
    amplitudes[present] = rotated if pitches > 0 else rotated.conj()  # conjugate: the mesh runs backwards
    return amplitudes


def _solve(
    at: Excited,
    force: ComplexArray,
    omega: FloatArray | ComplexArray,
    terms: Sequence[Terms] = (),
    rows: FloatArray | None = None,
    second: ComplexArray | None = None,
    progress: Callable[[float], None] | None = None,
    fractions: bool = False,
) -> tuple[ComplexArray, float, FloatArray]:
    """Return the displacements (S, H, n, 1 + f), the relative residual, and the largest response (m, H).

    The first displacements are those by `force` (S or 1, H, n) on the freedoms, the others those per force
    along each of `rows` (f, n). The response is that to the forces `second` along the driving lines of
    action, the largest over the speeds. `terms` are those of `gyroscopic_terms` at each speed, or empty.
    `fractions` tries partial fractions by modes, which cost less. Blocks of speeds limit the memory.
    """
    per_meter = 1.0 / at.linear.scale
    mass, damping, total = _per_meter(at.linear)
    pushed = _right_sides(force, rows, second) * per_meter[:, None]
    saved = 1 if rows is None else 1 + len(rows)  # columns of the displacements
    watched = at.system.arrays.direction[at.system.driving_rows]
    largest = np.zeros((len(watched), omega.shape[1]))
    by_freedom = np.empty((pushed.shape[2], saved, *omega.shape), dtype=complex)  # its order in memory
    displacement, modal = np.moveaxis(by_freedom, (2, 3), (0, 1)), at.system.arrays.sparse.modal
    first = _first_eliminated(modal.first, terms)
    small = modal_elimination(modal, per_meter, total, damping, mass) if first else None
    tried = fractions and small is None and not terms
    by_modes = PartialFractions.of(total, mass, damping) if tried else None
    parts = np.stack([total, mass, damping]).astype(complex)
    maximum = max(float(np.max(np.abs(pushed[..., 0]), initial=0.0)), 1e-300)
    residual, farthest = np.float64(0.0), np.zeros(per_meter.size)  # farthest: the largest displacements
    for part in speed_blocks(omega.shape, per_meter.size**2):
        exciting = pushed if pushed.shape[0] == 1 else pushed[part]
        right = np.broadcast_to(exciting, (*omega[part].shape, *pushed.shape[2:]))
        swept = _swept(terms[part], per_meter)
        # an undamped mode at its natural frequency divides by 0
        with np.errstate(divide="ignore", invalid="ignore"):
            if by_modes is not None:
                solution, miss = by_modes.solve(omega[part], exciting)
                # `not <=` also for NaN; then this block and all later ones are solved directly
                if not np.max(miss, initial=0.0) <= PRECISE * maximum:
                    by_modes = None
            if by_modes is None and small is None:
                solution, miss = _dense(parts, omega[part], swept, right)
            elif small is not None:
                turning = [matrix[:, :first, :first] for matrix in swept]
                solution = small.solve(omega[part], right, turning)
                miss = np.abs(small.product(omega[part], solution[..., :1], turning) - right[..., :1])
        residual = np.maximum(residual, np.max(miss, initial=0.0))  # not a number, if any of them is
        farthest = np.maximum(farthest, np.max(np.abs(solution[..., 0]), axis=(0, 1), initial=0.0))
        displacement[part] = solution[..., :saved] * per_meter[:, None]
        if second is not None:
            along = np.max(np.abs(solution[..., saved] * per_meter @ watched.T), axis=0, initial=0.0)
            largest = np.maximum(largest, along.T)
        if progress is not None:
            progress(min(part.stop, omega.shape[0]) / omega.shape[0])
    elastic = np.max(np.abs(total) @ farthest, initial=0.0)
    if not np.maximum(residual, np.finfo(float).eps * elastic) <= ROUNDED * maximum:
        raise unbounded(at.linear, omega)
    return displacement, float(residual / maximum), largest


def _per_meter(linear: LinearSystem) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mass, damping and stiffness (n, n) of freedoms that are all in meters."""
    per_meter = 1.0 / linear.scale
    mass, damping, stiffness = (
        per_meter[:, None] * matrix * per_meter for matrix in (linear.mass, linear.damping, linear.stiffness)
    )
    return mass, damping, stiffness


def _first_eliminated(first: int, terms: Sequence[Terms]) -> int:
    """Return the first modal freedom to eliminate; 0: none, because `terms` act on modal freedoms."""
    acts = any(np.any(part[first:]) or np.any(part[:, first:]) for term in terms for part in term)
    return 0 if acts else first


def _swept(terms: Sequence[Terms], per_meter: FloatArray) -> list[FloatArray]:
    """Return the scaled damping and stiffness (S, n, n) of terms at some speeds; empty without terms."""
    if not terms:
        return []
    return [np.stack([per_meter[:, None] * term[k] * per_meter for term in terms]) for k in (0, 1)]


def _right_sides(force: ComplexArray, rows: FloatArray | None, second: ComplexArray | None) -> ComplexArray:
    """Return the right sides (S or 1, H, n, c): `force`, a unit force along each of `rows`, and `second`."""
    sides = [force[..., None]]
    if rows is not None:
        sides.append(np.broadcast_to(rows.T, (*force.shape, len(rows))))
    if second is not None:
        sides.append(second[..., None])
    return np.concatenate(sides, axis=-1)


def _dense(
    parts: ComplexArray, omega: FloatArray | ComplexArray, swept: Sequence[FloatArray], right: ComplexArray
) -> tuple[ComplexArray, FloatArray]:
    """Return the displacements (S, H, n, c) by `right`, and the residuals (S, H, n) of the first column.

    `parts` are K, M, C (3, n, n); `swept` are gyroscopic and frame terms (S, n, n), or nothing.
    """
    w, size = omega[:, :, None, None], parts.shape[1]
    by_part = np.concatenate([np.ones_like(w), -w * w, 1j * w], axis=-1)
    matrix = (by_part[..., 0, :] @ parts.reshape(3, -1)).reshape(*w.shape[:2], size, size)
    matrix += turning_terms(w, swept)
    u = solved(matrix, right)
    miss = np.abs(np.einsum("shij,shj->shi", matrix, u[..., 0]) - right[..., 0])
    return u, np.asarray(miss, dtype=float)
