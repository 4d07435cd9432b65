"""The system linearized about its static equilibrium, and its natural modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.assembly.motion_and_loads import drive_springs
from dynamics.errors import InputError, SolveError
from dynamics.integrators import StaticSolution, static_equilibrium
from dynamics.mechanism.columns import elastic_terms
from dynamics.mechanism.frame_couplings import frame_couplings, frame_joint
from dynamics.motion.force_balance import at_mean_loads, force_balance
from dynamics.motion.observation import local_state
from dynamics.types import FloatArray

SPRING_KINDS = ("mesh", "bearing", "coupling", "drive", "shaft", "housing")


@dataclass(frozen=True)
class LinearSystem:
    """M dq'' + C dq' + K dq = 0 for small dq about the equilibrium, n freedoms, m flanks.

    The change of forces with the flanks' positions is left out: it is of the order of a deflection over a
    base pitch.
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
    """Motions that no spring resists: rotations of trains without a drive. Shape (k, n)."""
    spring: tuple[str, ...]
    """Names of all springs: meshes, bearings with direction, bearings with matrices, housings and couplings
    (once per principal stiffness), elastic drives, elastic coordinates of shafts.
    """
    strain: FloatArray
    """Strain of each spring per freedom, m or rad. Shape (p, n)."""
    spring_stiffness: FloatArray
    """Stiffnesses of the springs, N/m or N m/rad. Shape (p,)."""
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

    Bearings that are not linear have their `tangent` (R, P) at the equilibrium.
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
        rows, size = slice(start, start + at.directions.shape[0]), at.directions.shape[0]
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
            direction_of = zip("xyz", moves[index], supports.stiffness[index], strict=True)
            springs += [(f"{name}.{axis}", row, value) for axis, row, value in direction_of]
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
