"""Harmonic forced response to the transmission error, about the static equilibrium, over speeds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.checks import integer, one_of, positive
from dynamics.linearize.common_period import CommonPeriod, common_period
from dynamics.linearize.flank_cycles import SAMPLES, FlankCycle, averaged, flank_cycles
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.results.histories import bearing_force
from dynamics.system.assemble import System
from dynamics.system.force_balance import block_diagonal
from dynamics.system.observation import local_state
from dynamics.types import BoolArray, FloatArray, IntArray

ComplexArray = NDArray[np.complex128]

EXCITATIONS = ("static_error", "blocked_force")
BLOCK = 1_000_000  # entries of the matrices solved at once
NOTHING = 1e-12  # of the largest exciting force: harmonics below it are left out


@dataclass(frozen=True)
class HarmonicResponse:
    """Steady vibration at S speeds in H harmonics of the common period; m meshes, b bearings, n freedoms.

    Complex peak amplitudes A: the quantity is its mean and the sum over h of Re(A exp(2 pi i frequency t)),
    with all meshes at their position offsets at t = 0.

    Attributes
    ----------
    mesh, bearing, freedom : tuples of str
    speed : (S,) array
        Of the drive that stands for all, rad/s.
    order : (H,) array
        Multiples of the frequency of the first mesh that turns, those that are excited; fractions where
        tables or trains repeat after several pitches.
    frequency : (S, H) array
        Hz.
    static_transmission_error : (m, H) complex array
        What excites, at the static mesh forces, m.
    dynamic_transmission_error : (m, S, H) complex array
        m.
    mesh_force : (m, S, H) complex array
        Transverse, N.
    bearing_force : (b, 3, S, H) complex array
        On the ground or the pin, in the bearing's own frame, N; with seats (b, 6, S, H), moments in N m.
    displacement : (n, S, H) complex array
        m and rad.
    mean_force, mean_stiffness : (m,) arrays
        Static mesh force, N, and its tangent stiffness, mean over the positions, N/m.
    least_mesh_force : (m, S) array
        Of mean and all harmonics together, N: where it is negative flanks part, and no linear answer holds.
    residual : float
        Largest force left by the linear solves, of the largest exciting force.
    """

    mesh: tuple[str, ...]
    bearing: tuple[str, ...]
    freedom: tuple[str, ...]
    speed: FloatArray
    order: FloatArray
    frequency: FloatArray
    static_transmission_error: ComplexArray
    dynamic_transmission_error: ComplexArray
    mesh_force: ComplexArray
    bearing_force: ComplexArray
    displacement: ComplexArray
    mean_force: FloatArray
    mean_stiffness: FloatArray
    least_mesh_force: FloatArray
    residual: float = 0.0

    @property
    def in_contact(self) -> BoolArray:
        """Whether all driving flanks stay in contact at each speed, (S,) bool."""
        return np.asarray(np.all(self.least_mesh_force > 0.0, axis=0))


def harmonic_response(
    system: System,
    speed: FloatArray,
    orders: int = 10,
    time: float = 0.0,
    excitation: str = "static_error",
    progress: Callable[[float], None] | None = None,
) -> HarmonicResponse:
    """Return the linear response of `system` to its transmission errors at the speeds given.

    M u'' + C u' + (K + sum k g^T g) u = sum k g STE(t), with k the mean over the positions of the tangent
    stiffness at the static mesh force, and the tables read at the misalignment and centre distance at which
    the bodies rest; how stiffness varies with position (parametric excitation) is left out. Where the load
    moves along the face or there is friction, moment and friction of the static mesh force excite too.

    Parameters
    ----------
    system : System
    speed : (S,) array
        Of the first drive that turns, rad/s, either sign.
    orders : int
        Harmonics of the mesh frequency of the first mesh that turns.
    time : float
        When loads are taken, s.
    excitation : str
        ``"static_error"``: k times the STE's harmonics. ``"blocked_force"``: the force's harmonics while the
        transmission error is held at the mean of the STE; the same to first order in the STE's variation.
    progress : callable, optional
        Called with the fraction of the speeds done; what it raises ends the search.

    Raises
    ------
    InputError
        If a value is out of range, or the meshes have no common period.
    SolveError
        If there is no static equilibrium.
    """
    one_of("excitation", excitation, EXCITATIONS)
    integer("orders", orders, 1, SAMPLES // 4)
    speed = np.atleast_1d(np.asarray(speed, dtype=float))
    for index, value in enumerate(np.abs(speed)):
        positive(f"speed[{index}]", float(value))
    period, linear = common_period(system), linearize(system, time)
    cycles = flank_cycles(system, linear, time, orders)
    linear = averaged(system, linear, cycles, time)
    counted = next(pitches for pitches in period.pitches if pitches)
    harmonics: IntArray = np.arange(1, orders * abs(counted) + 1, dtype=np.int64)
    static, force = _excitation(system, cycles, period, harmonics, excitation)
    heard = np.max(np.abs(force), axis=0)
    kept = np.flatnonzero(heard > NOTHING * np.max(heard, initial=0.0))
    harmonics, static, force = harmonics[kept], static[:, kept], force[:, kept]
    omega = 2.0 * math.pi * harmonics / np.array([[period.duration(w)] for w in speed])
    u, residual = _solve(system, linear, force, omega, progress)
    order = harmonics / abs(counted)
    return _result(system, linear, cycles, time, speed, order, omega, static, force, u, residual)


def _excitation(
    system: System, cycles: tuple[FlankCycle, ...], period: CommonPeriod, harmonics: IntArray, kind: str
) -> tuple[ComplexArray, ComplexArray]:
    """STE (m, H) and exciting force on the driving flanks' rows (R', H): it pushes d up with the STE.

    Where the other forces of a flank (a moment as its load moves along the face, friction) vary while the
    mesh force is held, they excite too.
    """
    static = np.zeros((len(cycles), harmonics.size), dtype=complex)
    force = np.zeros((cycles[-1].rows.stop, harmonics.size), dtype=complex)
    for f, (mesh, cycle) in enumerate(zip(system.scene.meshes, cycles, strict=True)):
        place = period.pitches[f], mesh.table.period, mesh.position_offset, harmonics
        static[f] = _harmonics(cycle.static_error, *place)
        for p, row in enumerate(range(cycle.rows.start, cycle.rows.stop)):
            if kind == "static_error":
                held = (
                    _harmonics(cycle.force[:, p], *place) if p else 0.0
                )  # the first force is the same all along
                force[row] = cycle.tangent[p, 0] * static[f] - held
            else:
                force[row] = -_harmonics(cycle.blocked[:, p], *place)
    return static, force


def _harmonics(
    values: FloatArray, pitches: int, period: int, offset: float, harmonics: IntArray
) -> ComplexArray:
    """Amplitudes (H,) in multiples of the common period of a function of position, known over its table."""
    lines = 2.0 * np.fft.rfft(values) / values.size
    found = np.zeros(harmonics.size, dtype=complex)
    cycles = abs(pitches) // period
    if cycles == 0:
        return found
    which, rest = np.divmod(harmonics, cycles)
    there = (rest == 0) & (which < lines.size - 1)
    turned = lines[which[there]] * np.exp(2j * math.pi * which[there] * offset / period)
    found[there] = turned if pitches > 0 else turned.conj()
    return found


def _solve(
    system: System,
    linear: LinearSystem,
    force: ComplexArray,
    omega: FloatArray,
    progress: Callable[[float], None] | None,
) -> tuple[ComplexArray, float]:
    """Displacements, (S, H, n), and the relative residual; a block of speeds at a time."""
    g = system.arrays.direction[: force.shape[0]]
    per_metre = 1.0 / linear.scale
    mass, damping, total = (
        per_metre[:, None] * a * per_metre for a in (linear.mass, linear.damping, linear.stiffness)
    )
    pushed = (force.T @ g * per_metre)[None, :, :, None]
    found = np.empty((*omega.shape, g.shape[1]), dtype=complex)
    block = max(BLOCK // max(omega.shape[1] * g.shape[1] ** 2, 1), 1)
    left = 0.0
    for start in range(0, omega.shape[0], block):
        part = slice(start, start + block)
        w = omega[part, :, None, None]
        matrix = total - w * w * mass + 1j * w * damping
        right = np.broadcast_to(pushed, (*matrix.shape[:-1], 1))
        solved = np.linalg.solve(matrix, right)
        left = max(left, float(np.max(np.abs(matrix @ solved - right), initial=0.0)))
        found[part] = solved[..., 0] * per_metre
        if progress is not None:
            progress(min(start + block, omega.shape[0]) / omega.shape[0])
    return found, left / max(float(np.max(np.abs(pushed), initial=0.0)), 1e-300)


def _result(
    system: System,
    linear: LinearSystem,
    cycles: tuple[FlankCycle, ...],
    time: float,
    speed: FloatArray,
    order: FloatArray,
    omega: FloatArray,
    static: ComplexArray,
    force: ComplexArray,
    u: ComplexArray,
    residual: float,
) -> HarmonicResponse:
    """Put the result together from displacements (S, H, n)."""
    scene = system.scene
    dte = np.moveaxis(u @ system.arrays.direction[system.driving_rows].T, 2, 0)
    mesh_force = _mesh_force(system, linear, cycles, time, omega, force, u)
    mean = linear.equilibrium.mesh_force
    return HarmonicResponse(
        tuple(mesh.name for mesh in scene.meshes),
        system.supports.name,
        linear.freedom,
        speed,
        order,
        omega / (2.0 * math.pi),
        static,
        np.ascontiguousarray(dte),
        mesh_force,
        _bearing_force(system, linear, time, omega, u),
        np.ascontiguousarray(np.moveaxis(u, 2, 0)),
        mean,
        np.array([cycle.tangent[0, 0] for cycle in cycles]),
        mean[:, None] + _least(mesh_force, order),
        residual,
    )


def _mesh_force(
    system: System,
    linear: LinearSystem,
    cycles: tuple[FlankCycle, ...],
    time: float,
    omega: FloatArray,
    force: ComplexArray,
    u: ComplexArray,
) -> ComplexArray:
    """Transverse mesh forces, (m, S, H): mean tangent and damping on the coordinates, less what excites."""
    rest = np.zeros(u.shape[2])
    viscous = local_state(system.arrays, time, linear.equilibrium.displacement, rest).viscous
    found = np.empty((len(cycles), *omega.shape), dtype=complex)
    for f, cycle in enumerate(cycles):
        first, p = cycle.rows.start, cycle.tangent.shape[0]
        local = u @ system.arrays.direction[cycle.rows].T
        found[f] = local @ cycle.tangent[0] + 1j * omega * (local @ viscous[first, :p]) - force[first]
    return found


def _bearing_force(
    system: System, linear: LinearSystem, time: float, omega: FloatArray, u: ComplexArray
) -> ComplexArray:
    """Bearing forces (b, 3, S, H): those of a motion less those of none, real and imaginary parts apart."""
    q = u.reshape(-1, u.shape[2])
    rate = 1j * omega.reshape(-1, 1) * q
    elements, rest = system.arrays.elements, np.zeros(q.shape[1])
    at_rest = local_state(system.arrays, time, linear.equilibrium.displacement, rest)
    rows = system.arrays.direction.T
    local = (q @ rows) @ block_diagonal(elements, at_rest.tangent).T
    local = local + (rate @ rows) @ block_diagonal(elements, at_rest.viscous).T
    none = bearing_force(system, np.zeros((rows.shape[1], 1)), rest[None, :], rest[None, :])
    real, imaginary = (
        bearing_force(system, np.ascontiguousarray(part(local.T)), part(q), part(rate)) - none
        for part in (np.real, np.imag)
    )
    found = real + 1j * imaginary
    return np.asarray(found.reshape(*found.shape[:2], *u.shape[:2]))


def _least(amplitude: ComplexArray, order: FloatArray) -> FloatArray:
    """Return the least sum of all harmonics over the period, (m, S)."""
    base = float(np.min(np.diff(order, prepend=0.0))) if order.size else 1.0
    harmonic = np.rint(order / base).astype(int)
    samples = 8 * int(harmonic[-1] + 1) if order.size else 1
    lines = np.zeros((*amplitude.shape[:2], samples // 2 + 1), dtype=complex)
    lines[..., harmonic] = amplitude * (samples / 2.0)
    return np.asarray(np.min(np.fft.irfft(lines, samples, axis=-1), axis=-1))
