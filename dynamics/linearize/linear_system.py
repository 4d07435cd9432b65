"""The system linearized about its static equilibrium, and its natural modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.assembly.motion_and_loads import drive_springs
from dynamics.errors import InputError, SolveError
from dynamics.integrators import StaticSolution, static_equilibrium
from dynamics.mechanism.columns import elastic_terms
from dynamics.mechanism.connections import frame_couplings, frame_joint
from dynamics.motion.force_balance import at_mean_loads, force_balance
from dynamics.motion.observation import local_state
from dynamics.types import ComplexArray, FloatArray

HELD_BY = ("mesh", "bearing", "coupling", "drive", "shaft", "housing")
MOVES = {
    "x": "lateral",
    "y": "lateral",
    "z": "axial",
    "tilt_x": "tilting",
    "tilt_y": "tilting",
    "rotation": "torsional",
    "bending_x": "bending",
    "bending_y": "bending",
    "stretch": "axial",
    "twist": "torsional",
    "mode": "housing",
}


@dataclass(frozen=True)
class LinearSystem:
    """M dq'' + C dq' + K dq = 0 for small dq about the equilibrium, n freedoms, m flanks.

    How forces change with the flanks' positions is left out: of the order of a deflection over a base pitch.
    """

    freedom: tuple[str, ...]
    """"shaft.kind", as in `Freedoms`."""
    scale: FloatArray
    """Meters per unit of each freedom: 1, or a radius for rotations. Shape (n,)."""
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    """`mass`, `damping`, `stiffness`: M, C, K; symmetric. Shape (n, n) each."""
    rigid: FloatArray
    """Motions that nothing resists: those of trains without a drive. Shape (k, n)."""
    spring: tuple[str, ...]
    """Names of all springs: meshes, bearings with direction, bearings with matrices, housings and couplings
    (once per principal stiffness), elastic drives, elastic coordinates of shafts.
    """
    strain: FloatArray
    """Strain of each spring per freedom, m or rad. Shape (p, n)."""
    spring_stiffness: FloatArray
    """N/m or N m/rad. Shape (p,)."""
    equilibrium: StaticSolution


def require_freedoms(system: System) -> None:
    """Refuse a system of which nothing can vibrate; raises `InputError`."""
    if not system.freedoms.name:
        raise InputError("freedoms", 0, "at least one", "Leave a shaft free to turn, or switch effects on.")


def about_running(system: System) -> System:
    """Return `system` for small motions about gears that run in the sense of the scene.

    Friction then has the direction of running, also at a time of rest, and no slope in the speed. Loads that
    change with an angle are at their means.
    """
    arrays = at_mean_loads(system.arrays)
    elements = arrays.elements
    if elements.laws.spatial_flank.running.size > 0:
        laws = elements.laws._replace(spatial_flank=elements.laws.spatial_flank.as_running())
        arrays = arrays._replace(elements=elements._replace(laws=laws))
    return replace(system, arrays=arrays)


def linearize(system: System, time: float = 0.0) -> LinearSystem:
    """Linearize `system` about its static equilibrium under the loads at `time`, gears running.

    Raises
    ------
    SolveError
        If there is no static equilibrium.
    """
    system = about_running(system)
    start = static_equilibrium(system, time)
    if not start.status.usable:
        raise SolveError(f"no static equilibrium: {start.status.name.lower()}, {start.residual:.3g} N left")
    arrays = system.arrays
    rest = np.zeros(start.displacement.size)
    balance = force_balance(arrays, time, start.displacement, rest, rest, gyroscopic=False)
    free = arrays.reference.freedom >= 0
    names, strain, coefficient = _springs(system, time, balance.local.tangent)
    return LinearSystem(
        freedom=system.freedoms.name,
        scale=arrays.scale,
        mass=arrays.mass,
        damping=balance.damping,
        stiffness=balance.stiffness,
        rigid=arrays.reference.vector[free],
        spring=names,
        strain=strain,
        spring_stiffness=coefficient,
        equilibrium=start,
    )


def _matrices(system: System, time: float, tangent: FloatArray) -> list[tuple[str, FloatArray, FloatArray]]:
    """Names, strains per freedom, and stiffness matrices of bearings and couplings at `time`.

    Those of bearings that are not linear are by their `tangent` (R, P) at the equilibrium.
    """
    seats, couplings, keep = system.seats, system.couplings, system.freedoms.keep
    bearings = [(name, keep(seats.motion[at]), seats.stiffness[at, at]) for name, at in seats.group]
    joints = zip(couplings.name, couplings.motion, couplings.stiffness, strict=True)
    springs = [*bearings, *((name, keep(motion), matrix) for name, motion, matrix in joints)]
    n = system.arrays.mass.shape[0]
    parts = frame_couplings(system.scene)
    turned = local_state(system.arrays, time, np.zeros(n), np.zeros(n)).position[len(system.scene.meshes) :]
    for part, turn in zip(parts, turned[: len(parts)], strict=True):
        motion, matrix = frame_joint(system.scene, system.rotors, part, 2.0 * np.pi * float(turn))
        springs.append((system.couplings.name[part.coupling], keep(motion), matrix))
    first = system.arrays.elements.first[len(system.elements) - len(system.bearings) :]
    for start, at in zip(first, system.bearings, strict=False):
        rows, size = slice(start, start + at.way.shape[0]), at.way.shape[0]
        matrix = 0.5 * (tangent[rows, :size] + tangent[rows, :size].T)
        springs.append((system.supports.name[at.support], system.arrays.direction[rows], matrix))
    return springs


def _springs(
    system: System, time: float, tangent: FloatArray
) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """Names, strains per freedom and stiffnesses of all springs."""
    direction, supports, freedoms = system.arrays.direction, system.supports, system.freedoms
    moves, meshes = freedoms.keep(supports.motion), zip(system.scene.meshes, system.driving_rows, strict=True)
    springs: list[tuple[str, FloatArray, float]] = [
        (mesh.name, direction[row], tangent[row, 0]) for mesh, row in meshes
    ]
    for index, name in enumerate(supports.name):
        if index not in system.seats.support:
            own = zip("xyz", moves[index], supports.stiffness[index], strict=True)
            springs += [(f"{name}.{axis}", row, value) for axis, row, value in own]
    for name, motion, matrix in _matrices(system, time, tangent):
        values, vectors = np.linalg.eigh(matrix)
        principal = zip(values, vectors.T, strict=True)
        springs += [(name, np.asarray(vector @ motion), value) for value, vector in principal if value > 0.0]
    for _, drive, row in drive_springs(system.scene, system.kinematics, system.rotors, freedoms):
        springs.append((drive.name, row, drive.stiffness or 0.0))
    elastic = elastic_terms(system.rotors)[0][freedoms.column]
    unit = np.eye(elastic.size)
    springs += [(freedoms.name[bent], unit[bent], elastic[bent]) for bent in np.flatnonzero(elastic > 0.0)]
    return (
        tuple(name for name, _, _ in springs),
        np.array([row for _, row, _ in springs]).reshape(len(springs), direction.shape[1]),
        np.array([value for _, _, value in springs], dtype=float),
    )


# Distribution of the energy of a mode: strain energy by spring, kinetic energy by freedom.


def strain_shares(
    linear: LinearSystem, shape: FloatArray | ComplexArray, still: NDArray[np.bool_] | None = None
) -> FloatArray:
    """Return the share of each spring in the strain energy of each mode, (a, p); mean over a cycle.

    `shape` (a, n) holds one mode per row; those that are `still` (a,), motions that nothing resists, get 0.
    """
    energy = linear.spring_stiffness * np.abs(shape @ linear.strain.T) ** 2
    total = np.sum(energy, axis=1, keepdims=True)
    none = total <= 0.0 if still is None else (total <= 0.0) | still[:, None]
    return np.asarray(np.where(none, 0.0, energy / np.where(total > 0.0, total, 1.0)))


def kinetic_shares(linear: LinearSystem, shape: FloatArray | ComplexArray) -> FloatArray:
    """Return the share of each freedom in the kinetic energy of each mode, (a, n); mean over a cycle."""
    energy = np.real(np.conj(shape) * (shape @ linear.mass))
    return np.asarray(energy / np.sum(energy, axis=1, keepdims=True))


def spring_parts(system: System, spring: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the part that each of `spring` belongs to and its kind, one of `HELD_BY`.

    The springs of a bearing's directions are one part, and so are the modes of a housing; a housing without
    mass is one with its bearings. What is no mesh, bearing, housing, coupling or drive is of a shaft that
    bends.
    """
    scene = system.scene
    kinds = {part.name: "housing" for part in system.rotors.housings}
    condensed = (part.name for part in scene.housings if part.name not in kinds)
    kinds |= dict.fromkeys((*system.supports.name, *condensed), "bearing")
    kinds |= {part.name: "coupling" for part in scene.couplings}
    kinds |= {part.name: "drive" for part in scene.drives}
    meshes = {mesh.name for mesh in scene.meshes}
    parts = []
    for index, name in enumerate(spring):
        part = name
        if index < len(scene.meshes) and name in meshes:
            parts.append((name, "mesh"))
            continue
        if name not in kinds:
            part = name.rpartition(".")[0]
        parts.append((part or name, kinds.get(part, "shaft")))
    return tuple(parts)


def freedom_parts(freedom: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the body of each freedom "body.kind" and how it moves along it, one of the `MOVES`."""
    pairs = [name.rpartition(".")[::2] for name in freedom]
    return tuple((shaft, MOVES[kind.rstrip("_0123456789")]) for shaft, kind in pairs)


@dataclass(frozen=True)
class Modes:
    """Natural modes, by rising frequency; the motions that nothing resists come first, at 0 Hz exactly."""

    frequency: FloatArray
    """Undamped, Hz. Shape (n,)."""
    damping_ratio: FloatArray
    """Modal: shape^T C shape / (2 omega); 0 for the modes at 0 Hz. Shape (n,)."""
    shape: FloatArray
    """One mode per row, per freedom in m and rad, of unit modal mass: shape M shape^T = 1. Shape (n, n)."""
    freedom: tuple[str, ...]
    """Names of the columns, "shaft.kind"."""
    scale: FloatArray
    """Meters per unit of each freedom: ``shape * scale`` compares translations and rotations. Shape (n,)."""
    spring: tuple[str, ...]
    """Names of the springs: meshes, bearings with direction, elastic drives."""
    strain_energy: FloatArray
    """Share of each spring in the strain energy of each mode; 0 at 0 Hz. Shape (n, p)."""
    kinetic_energy: FloatArray
    """Share of each freedom in the kinetic energy of each mode. Shape (n, n)."""


def natural_modes(system: System | LinearSystem, time: float = 0.0) -> Modes:
    """Return the natural modes of `system` about its static equilibrium under the loads at `time`.

    Raises
    ------
    SolveError
        If there is no static equilibrium.
    """
    linear = linearize(system, time) if isinstance(system, System) else system
    square, shape = _solve(linear)
    omega = np.sqrt(np.maximum(square, 0.0))
    damping = np.einsum("ai,ij,aj->a", shape, linear.damping, shape)
    still = omega == 0.0
    ratio = np.where(still, 0.0, damping / np.where(still, 1.0, 2.0 * omega))
    return Modes(
        frequency=omega / (2.0 * math.pi),
        damping_ratio=ratio,
        shape=shape,
        freedom=linear.freedom,
        scale=linear.scale,
        spring=linear.spring,
        strain_energy=strain_shares(linear, shape, still),
        kinetic_energy=shape * (shape @ linear.mass),
    )


def _solve(linear: LinearSystem) -> tuple[FloatArray, FloatArray]:
    """Squared circular frequencies (n,) and shapes (n, n) of unit modal mass, rigid motions exactly."""
    per_meter = 1.0 / linear.scale
    mass, stiffness = (per_meter[:, None] * a * per_meter for a in (linear.mass, linear.stiffness))
    rigid = linear.rigid * linear.scale
    if rigid.shape[0] == 0:
        square, vectors = eigh(stiffness, mass)
        return square, np.asarray(vectors.T * per_meter)
    still = np.linalg.solve(np.linalg.cholesky(rigid @ mass @ rigid.T), rigid)
    rest = null_space(still @ mass)
    square, vectors = eigh(rest.T @ stiffness @ rest, rest.T @ mass @ rest)
    shapes = np.concatenate([still, (rest @ vectors).T])
    return np.concatenate([np.zeros(still.shape[0]), square]), np.asarray(shapes * per_meter)


def unbounded(linear: LinearSystem, omega: FloatArray | ComplexArray) -> SolveError:
    """Return the refusal of a vibration that nothing bounds at one of the frequencies, rad/s.

    It names the mode with the least distance from a frequency and damping, both in parts of its own.
    """
    modes, excited = natural_modes(linear), np.unique(np.abs(omega)) / (2.0 * math.pi)
    held = np.flatnonzero(modes.frequency)
    words = "a harmonic of the speed excites an undamped mode"
    if held.size:
        own = modes.frequency[held]
        off = np.abs(excited[:, None] / own - 1.0) + modes.damping_ratio[held]
        at, mode = np.unravel_index(np.argmin(off), off.shape)
        part = modes.freedom[int(np.argmax(modes.kinetic_energy[held[mode]]))]
        words = f"{excited[at]:.6g} Hz excite the mode at {own[mode]:.6g} Hz, in which {part} moves most and "
        words += f"whose damping ratio is {engineering(modes.damping_ratio[held[mode]], 1)}"
    advice = "Give the meshes, shafts or supports damping, or leave that speed out"
    return SolveError(f"the vibration is unbounded: {words}. {advice}")
