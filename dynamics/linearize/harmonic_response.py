"""Harmonic response to the transmission errors, with mean stiffnesses and with those that vary.

Harmonics are multiples of the frequency of the common period, after which all meshes and loads are in phase
again. An order is a multiple of the frequency of the first mesh that turns. The floor is the sum of the lines
of a long period that are not solved. In functions, `at` is the excited system at its static equilibrium.

Shapes: S speeds, H harmonics, m meshes, b bearings, n freedoms.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.checks import integer, one_of, positive
from dynamics.forces.laws import Law
from dynamics.linearize.flank_cycles import SAMPLES
from dynamics.linearize.line_floor import LineFloor, floor_frequencies, floor_inputs
from dynamics.linearize.operating_speeds import LARGEST_DENOMINATOR
from dynamics.linearize.steady_vibration import (
    EXCITATIONS,
    Excited,
    Steady,
    excited,
    harmonics_of,
    receptances,
    speed_blocks,
    steady_vibration,
)
from dynamics.linearize.strongest_lines import Lines, strongest_lines
from dynamics.motion.force_balance import block_diagonal
from dynamics.results.array_file import stored
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray
from host.optional_modules import fft

GRID = ("speed", "order")
MAX_SAMPLES, MAX_PER_LINE, MAX_PARTED = 16_384, 1_000, 300
"""Bounds up to which `extremes` samples the sum of all harmonics over the whole period, and is exact.

They are samples of a period in all, samples per order (the larger of the two bounds counts), and orders.
"""
_SAMPLES_PER_CYCLE = 8
"""Samples per cycle of the highest harmonic in `extremes`: a peak is at most 8 % too low."""


def _none() -> ComplexArray:
    return np.empty((0, 0), dtype=complex)


@dataclass(frozen=True)
class HarmonicResponse:
    """Steady vibration at S speeds in H harmonics of the common period; m meshes, b bearings, n freedoms.

    Complex peak amplitudes A: the quantity is its mean and the sum over h of Re(A exp(2 pi i frequency t)),
    with all meshes at their position offsets at t = 0. Fields state unit, meaning and dimensions of arrays.
    """

    mesh: tuple[str, ...]
    bearing: tuple[str, ...]
    freedom: tuple[str, ...]
    speed: FloatArray = field(metadata=stored("rad s-1", "speed of the leading shaft", "speed"))
    order: FloatArray = field(
        metadata=stored("1", "multiple of the frequency of the first mesh that turns", "order")
    )
    """Excited multiples of the frequency of the first mesh that turns; fractions where tables or trains
    repeat after several pitches. Shape (H,).
    """
    frequency: FloatArray = field(metadata=stored("Hz", "frequency of the harmonic", "speed", "order"))
    static_transmission_error: ComplexArray = field(
        metadata=stored("m", "complex amplitude of the excitation", "mesh", "order")
    )
    """`static_transmission_error`, `load_moment`, `friction_force`: Excitations at the static mesh forces.
    The moment is that of the load as it travels along the face, about the axis of a misalignment. The
    friction acts along the sliding at the pitch point. Meshes without a moment or friction have 0. Empty in
    older files. Shape (m, H) each.
    """
    dynamic_transmission_error: ComplexArray = field(metadata=stored("m", "complex amplitude", "mesh", *GRID))
    mesh_force: ComplexArray = field(metadata=stored("N", "complex amplitude, transverse", "mesh", *GRID))
    bearing_force: ComplexArray = field(
        metadata=stored(
            "N or N m", "complex amplitude on the ground or the pin", "bearing", "direction", *GRID
        )
    )
    """Force on the ground or the pin, in the bearing's own frame, N; with seats (b, 6, S, H), moments in N m.
    Shape (b, 3, S, H).
    """
    displacement: ComplexArray = field(metadata=stored("m or rad", "complex amplitude", "freedom", *GRID))
    mean_force: FloatArray = field(metadata=stored("N", "static mesh force", "mesh"))
    mean_stiffness: FloatArray = field(
        metadata=stored("N m-1", "tangent stiffness, mean over the positions", "mesh")
    )
    least_mesh_force: FloatArray = field(
        metadata=stored("N", "least of mean and harmonics together", "mesh", "speed")
    )
    """Least mesh force over the period, mean and harmonics together, N. Where it is negative the flanks part,
    and the linear response does not hold. Shape (m, S).
    """
    residual: float = 0.0
    """Largest force left by the linear solves, over the largest exciting force."""
    load_moment: ComplexArray = field(
        default_factory=_none, metadata=stored("N m", "complex amplitude of the excitation", "mesh", "order")
    )
    friction_force: ComplexArray = field(
        default_factory=_none, metadata=stored("N", "complex amplitude of the excitation", "mesh", "order")
    )
    floor: LineFloor | None = None
    """Sum of the lines of a long period that are left out; None where none is left out, and in a response
    that was read from a file.
    """

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
    stiffness at the static mesh force, and the tables read at the misalignment and center distance at which
    the bodies rest; how stiffness varies with position (parametric excitation) is left out. Where the load
    moves along the face or there is friction, moment and friction of the static mesh force excite too.

    Parameters
    ----------
    speed : (S,) array
        Speeds of the first drive that turns, rad/s, either sign.
    orders : int
        Harmonics of the mesh frequency of the first mesh that turns.
    time : float
        Time at which loads that vary are taken, s.
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
    speed = np.atleast_1d(np.asarray(speed, dtype=float))
    for index, value in enumerate(np.abs(speed)):
        positive(f"speed[{index}]", float(value))
    at, lines = excited_lines(system, orders, time, speed)
    steady = steady_vibration(at, speed, lines.harmonics, excitation, progress=progress)
    return replace(response_of(at, speed, steady), floor=floor_of(at, speed, lines))


def excited_lines(system: System, orders: int, time: float, speed: FloatArray) -> tuple[Excited, Lines]:
    """Return the excitation of `system`, and the `strongest_lines` up to `orders` at `speed` (S,), rad/s.

    Raises
    ------
    InputError
        If `orders` is out of range, or the meshes have no common period.
    SolveError
        If there is no static equilibrium.
    """
    integer("orders", orders, 1, SAMPLES // 4)
    at = excited(system, time, orders)
    return at, strongest_lines(at, np.arange(1, orders * at.period.counted + 1, dtype=np.int64), speed)


def floor_of(at: Excited, speed: FloatArray, lines: Lines) -> LineFloor | None:
    """Return the floor of the lines left out at `speed` (S,); None without any, or with a rotating frame."""
    if not lines.omitted.size or at.turning:
        return None
    # frequency of the common period, Hz, by speed
    pace = np.array([1.0 / at.period.duration(float(value)) for value in speed])
    inputs, force = floor_inputs(at, lines.omitted), []
    hertz = floor_frequencies(at, lines.omitted[0] * np.min(pace), lines.omitted[-1] * np.max(pace))
    for part in speed_blocks((hertz.size, 1), inputs.row.size):
        omega = 2.0 * math.pi * hertz[part]
        # motions by each input; the inputs take the place of the harmonics (G, e, n)
        by_input = np.moveaxis(receptances(at, omega, inputs.row)[:, 0], 2, 1)
        force.append(bearing_forces(at, np.repeat(omega[:, None], len(inputs.row), axis=1), by_input))
    return LineFloor(
        bearing=at.system.supports.name,
        pace=pace,
        harmonic=lines.omitted,
        inputs=inputs.size,
        frequency=hertz,
        bearing_force=np.concatenate(force, axis=2),
        changed=np.zeros((len(at.system.supports.name), speed.size)),
    )


def varied_floor(
    at: Excited, speed: FloatArray, lines: Lines, response: HarmonicResponse
) -> LineFloor | None:
    """Return `floor_of`, with its relative change by a varying stiffness, by bearing and speed.

    The change is an estimate. A varying stiffness couples lines, but in `response` only the solved ones. Let
    r be the relative change (rms) of the solved bearing forces by it, P the power of the lines left out and Q
    that of the solved ones. If the lines left out change by r too, and add r times their force to the solved
    lines, the power changes by 2 r (P + sqrt(P Q)) + r^2 P.
    """
    floor = floor_of(at, speed, lines)
    if floor is None:
        return None
    harmonics = np.rint(response.order * at.period.counted).astype(np.int64)
    mean = steady_vibration(at, speed, harmonics)
    shared = response.bearing_force[..., np.isin(harmonics, mean.harmonics)]
    changed = shared - bearing_forces(at, mean.omega, mean.displacement)
    squares, _ = floor.of_bearings()  # P
    listed = 0.5 * np.sum(np.abs(shared[:, :3]) ** 2, axis=(1, 3))  # Q: forces, without moments
    change = 0.5 * np.sum(np.abs(changed[:, :3]) ** 2, axis=(1, 3))
    part = np.sqrt(change / np.maximum(listed, 1e-300))  # r; 1e-300: no division by zero
    factor = 1.0 + np.sqrt(listed / np.maximum(squares, 1e-300))
    return replace(floor, changed=2.0 * part * factor + part**2)


def response_of(at: Excited, speed: FloatArray, steady: Steady) -> HarmonicResponse:
    """Return the response of meshes and bearings to a vibration at `speed` (S,)."""
    system, linear = at.system, at.linear
    dte = along_rows(steady.displacement, system.arrays.direction[system.driving_rows])
    mesh_force, mean = _mesh_force(at, steady), linear.equilibrium.mesh_force
    order = steady.harmonics / at.period.counted
    moment, friction = _static_loads(at, steady.harmonics)
    return HarmonicResponse(
        mesh=tuple(mesh.name for mesh in system.scene.meshes),
        bearing=system.supports.name,
        freedom=linear.freedom,
        speed=speed,
        order=order,
        frequency=steady.omega / (2.0 * math.pi),
        static_transmission_error=steady.static,
        dynamic_transmission_error=np.ascontiguousarray(dte),
        mesh_force=mesh_force,
        bearing_force=bearing_forces(at, steady.omega, steady.displacement),
        displacement=np.ascontiguousarray(np.moveaxis(steady.displacement, 2, 0)),
        mean_force=mean,
        mean_stiffness=np.array([cycle.tangent[0, 0] for cycle in at.cycles]),
        least_mesh_force=mean[:, None] + extremes(mesh_force, order)[0],
        residual=steady.residual,
        load_moment=moment,
        friction_force=friction,
    )


def _static_loads(at: Excited, harmonics: IntArray) -> ComplexArray:
    """Return the harmonics of moments (N m) and friction (N) of the static mesh forces, (2, m, H)."""
    elements, loads = at.system.arrays.elements, np.zeros((2, len(at.cycles), harmonics.size), dtype=complex)
    laws = elements.laws.spatial_flank
    for mesh, cycle in enumerate(at.cycles):
        if elements.law[mesh] != Law.SPATIAL_FLANK:
            continue
        entry = elements.entry[mesh]
        tilting, _, sliding = (int(row) for row in laws.row[entry])
        if laws.per_face[entry] > 0.0:  # the load moves along the face; the row has moment times per_face
            moment = -cycle.force[:, tilting] / laws.per_face[entry]
            loads[0, mesh] = harmonics_of(at, mesh, moment, harmonics)
        if sliding > 0:  # 0: the flank has no row of friction
            loads[1, mesh] = harmonics_of(at, mesh, cycle.force[:, sliding], harmonics)
    return loads


def _mesh_force(at: Excited, steady: Steady) -> ComplexArray:
    """Return the transverse mesh forces, (m, S, H), N.

    They are mean tangent and damping on the coordinates of a mesh's p rows, less the exciting force.
    """
    system, u, omega, viscous = at.system, steady.displacement, steady.omega, at.at_rest.viscous
    force = np.empty((len(at.cycles), *omega.shape), dtype=complex)
    for f, cycle in enumerate(at.cycles):
        first, p = cycle.rows.start, cycle.tangent.shape[0]
        local = np.moveaxis(along_rows(u, system.arrays.direction[cycle.rows]), 0, 2)
        force[f] = (
            local @ cycle.tangent[0] + 1j * omega * (local @ viscous[first, :p]) - steady.force[:, first]
        )
    return force


def along_rows(u: ComplexArray, rows: FloatArray) -> ComplexArray:
    """Return the coordinates (k, S, H) of rows (k, n) by motions u (S, H, n), freedom by freedom."""
    return np.asarray(np.tensordot(rows, np.moveaxis(u, 2, 0), 1))


def bearing_forces(at: Excited, omega: FloatArray, u: ComplexArray) -> ComplexArray:
    """Return the bearing forces (b, 3 or 6, S, H) by motions (S, H, n) at omega (S, H).

    `System.bearing_force` takes real motions, and includes the static force. So it is called for the real and
    for the imaginary part, and its force without motion is subtracted.
    """
    system, rest = at.system, np.zeros((1, u.shape[2]))
    elements, rows = system.arrays.elements, system.arrays.direction.T
    tangent, viscous = (block_diagonal(elements, part).T for part in (at.at_rest.tangent, at.at_rest.viscous))
    static = system.bearing_force(np.zeros((rows.shape[1], 1)), rest, rest)
    force = np.empty((*static.shape[:2], *u.shape[:2]), dtype=complex)
    for part in speed_blocks(omega.shape, 4 * rows.shape[1]):
        q = u[part].reshape(omega[part].size, u.shape[2])
        rate = 1j * omega[part].reshape(-1, 1) * q
        local = (q @ rows) @ tangent + (rate @ rows) @ viscous
        for whole, side in ((force.real, np.real), (force.imag, np.imag)):
            moved = system.bearing_force(np.ascontiguousarray(side(local).T), side(q), side(rate)) - static
            whole[:, :, part] = moved.reshape(whole[:, :, part].shape)
    return force


def extremes(amplitude: ComplexArray, order: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least and the largest sum of all harmonics (m, S, H) over the period, (m, S) each.

    A period of more samples than `MAX_SAMPLES`, and than `MAX_PER_LINE` an order, is not sampled. Orders
    whose ratio is no ratio of small integers meet in all phases over such a period. So the multiples of the
    first order and the other orders are sampled by themselves, and their extremes added. With more than
    `MAX_PARTED` orders the sum of all amplitudes is returned as a bound.
    """
    harmonic = _harmonics(tuple(order.tolist()))
    samples = _SAMPLES_PER_CYCLE * int(harmonic[-1] + 1) if order.size else 1
    is_multiple = harmonic % harmonic[:1] == 0
    if samples > max(MAX_SAMPLES, MAX_PER_LINE * order.size) and not np.all(is_multiple):
        if order.size > MAX_PARTED:
            maximum = np.sum(np.abs(amplitude), axis=-1)
            return -maximum, maximum
        parts = (
            extremes(amplitude[..., is_multiple], order[is_multiple]),
            extremes(amplitude[..., ~is_multiple], order[~is_multiple]),
        )
        return parts[0][0] + parts[1][0], parts[0][1] + parts[1][1]
    if samples > MAX_SAMPLES:
        samples = fft.next_fast_len(samples, real=True)
    minimum, maximum = np.empty(amplitude.shape[:2]), np.empty(amplitude.shape[:2])
    for part in speed_blocks((amplitude.shape[1], samples), amplitude.shape[0]):
        few = amplitude[:, part]
        lines = np.zeros((*few.shape[:2], samples // 2 + 1), dtype=complex)
        lines[..., harmonic] = few * (samples / 2.0)  # peak amplitudes as `irfft` counts them
        wave = np.fft.irfft(lines, samples, axis=-1)
        minimum[:, part], maximum[:, part] = np.min(wave, axis=-1), np.max(wave, axis=-1)
    return minimum, maximum


@lru_cache(maxsize=64)
def _harmonics(order: tuple[float, ...]) -> IntArray:
    """Return the orders (H,) as integer multiples of their greatest common divisor."""
    parts = [Fraction(value).limit_denominator(LARGEST_DENOMINATOR) for value in order]
    scale = math.lcm(*(part.denominator for part in parts))
    multiples = [int(part * scale) for part in parts]
    return np.array(multiples, dtype=np.int64) // max(math.gcd(*multiples), 1)
