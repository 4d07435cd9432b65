"""Harmonic forced response to the transmission error, about the static equilibrium, over speeds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.checks import integer, one_of, positive
from dynamics.linearize.common_period import LARGEST_DENOMINATOR
from dynamics.linearize.flank_cycles import SAMPLES
from dynamics.linearize.steady_vibration import (
    EXCITATIONS,
    ComplexArray,
    Excited,
    Steady,
    excited,
    steady_vibration,
)
from dynamics.motion.force_balance import block_diagonal
from dynamics.motion.observation import local_state
from dynamics.types import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class HarmonicResponse:
    """Steady vibration at S speeds in H harmonics of the common period; m meshes, b bearings, n freedoms.

    Complex peak amplitudes A: the quantity is its mean and the sum over h of Re(A exp(2 pi i frequency t)),
    with all meshes at their position offsets at t = 0.

    Attributes
    ----------
    mesh, bearing, freedom : tuples of str
    speed : (S,) array
        Of the leading drive, rad/s.
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
    stiffness at the static mesh force, and the tables read at the misalignment and center distance at which
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
    speed = np.atleast_1d(np.asarray(speed, dtype=float))
    for index, value in enumerate(np.abs(speed)):
        positive(f"speed[{index}]", float(value))
    at, harmonics = excited_harmonics(system, orders, time)
    return response_of(at, speed, steady_vibration(at, speed, harmonics, excitation, progress=progress))


def excited_harmonics(system: System, orders: int, time: float) -> tuple[Excited, IntArray]:
    """Return what excites `system`, and the multiples (H,) of the common period's frequency up to `orders`.

    Raises
    ------
    InputError
        If `orders` is out of range, or the meshes have no common period.
    SolveError
        If there is no static equilibrium.
    """
    integer("orders", orders, 1, SAMPLES // 4)
    at = excited(system, time, orders)
    return at, np.arange(1, orders * at.period.counted + 1, dtype=np.int64)


def response_of(at: Excited, speed: FloatArray, steady: Steady) -> HarmonicResponse:
    """Say what a vibration at `speed` (S,) does to meshes and bearings."""
    system, linear = at.system, at.linear
    dte = np.moveaxis(steady.displacement @ system.arrays.direction[system.driving_rows].T, 2, 0)
    mesh_force, mean = _mesh_force(at, steady), linear.equilibrium.mesh_force
    order = steady.harmonics / at.period.counted
    return HarmonicResponse(
        tuple(mesh.name for mesh in system.scene.meshes),
        system.supports.name,
        linear.freedom,
        speed,
        order,
        steady.omega / (2.0 * math.pi),
        steady.static,
        np.ascontiguousarray(dte),
        mesh_force,
        _bearing_force(at, steady.omega, steady.displacement),
        np.ascontiguousarray(np.moveaxis(steady.displacement, 2, 0)),
        mean,
        np.array([cycle.tangent[0, 0] for cycle in at.cycles]),
        mean[:, None] + extremes(mesh_force, order)[0],
        steady.residual,
    )


def _mesh_force(at: Excited, steady: Steady) -> ComplexArray:
    """Transverse mesh forces, (m, S, H): mean tangent and damping on the coordinates, less what excites."""
    system, u, omega = at.system, steady.displacement, steady.omega
    rest = np.zeros(u.shape[2])
    viscous = local_state(system.arrays, at.time, at.linear.equilibrium.displacement, rest).viscous
    force = np.empty((len(at.cycles), *omega.shape), dtype=complex)
    for f, cycle in enumerate(at.cycles):
        first, p = cycle.rows.start, cycle.tangent.shape[0]
        local = u @ system.arrays.direction[cycle.rows].T
        force[f] = local @ cycle.tangent[0] + 1j * omega * (local @ viscous[first, :p]) - steady.force[first]
    return force


def _bearing_force(at: Excited, omega: FloatArray, u: ComplexArray) -> ComplexArray:
    """Bearing forces (b, 3, S, H): those of a motion less those of none, real and imaginary parts apart."""
    system = at.system
    q = u.reshape(-1, u.shape[2])
    rate = 1j * omega.reshape(-1, 1) * q
    elements, rest = system.arrays.elements, np.zeros(q.shape[1])
    at_rest = local_state(system.arrays, at.time, at.linear.equilibrium.displacement, rest)
    rows = system.arrays.direction.T
    local = (q @ rows) @ block_diagonal(elements, at_rest.tangent).T
    local = local + (rate @ rows) @ block_diagonal(elements, at_rest.viscous).T
    none = system.bearing_force(np.zeros((rows.shape[1], 1)), rest[None, :], rest[None, :])
    real, imaginary = (
        system.bearing_force(np.ascontiguousarray(part(local.T)), part(q), part(rate)) - none
        for part in (np.real, np.imag)
    )
    force = real + 1j * imaginary
    return np.asarray(force.reshape(*force.shape[:2], *u.shape[:2]))


def _whole(order: FloatArray) -> IntArray:
    """Return orders, fractions, as whole multiples of their largest common part."""
    parts = [Fraction(value).limit_denominator(LARGEST_DENOMINATOR) for value in order.tolist()]
    scale = math.lcm(*(part.denominator for part in parts))
    multiples = [int(part * scale) for part in parts]
    return np.array(multiples, dtype=np.int64) // max(math.gcd(*multiples), 1)


def extremes(amplitude: ComplexArray, order: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least and the largest sum of all harmonics (m, S, H) over the period, (m, S) each."""
    harmonic = _whole(order)
    samples = 8 * int(harmonic[-1] + 1) if order.size else 1
    lines = np.zeros((*amplitude.shape[:2], samples // 2 + 1), dtype=complex)
    lines[..., harmonic] = amplitude * (samples / 2.0)
    wave = np.fft.irfft(lines, samples, axis=-1)
    return np.asarray(np.min(wave, axis=-1)), np.asarray(np.max(wave, axis=-1))
