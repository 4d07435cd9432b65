"""The system linearized about its static equilibrium, and its natural modes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

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
"""Kinds of springs, whose shares of the strain energy of a mode are stated."""


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

    Friction then has the direction in which the gears run, even at a time at which they rest, and does not
    change with the speed. Loads that change with an angle are at their means.
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
    zero = np.zeros(start.displacement.size)  # rates and external forces, which leave the derivatives alone
    balance = force_balance(arrays, time, start.displacement, zero, zero, gyroscopic=False)
    free = arrays.reference.freedom >= 0  # laws of trains without a drive; others have no freedom (-1)
    springs = _springs(system, time, balance.local.tangent)
    strain = np.array([spring.strain for spring in springs])
    return LinearSystem(
        freedom=system.freedoms.name,
        scale=arrays.scale,
        mass=arrays.mass,
        damping=balance.damping,
        stiffness=balance.stiffness,
        rigid=arrays.reference.vector[free],
        spring=tuple(spring.name for spring in springs),
        strain=strain.reshape(len(springs), start.displacement.size),  # the shape of an empty list, too
        spring_stiffness=np.array([spring.stiffness for spring in springs], dtype=float),
        equilibrium=start,
    )


class _Joint(NamedTuple):
    """A bearing or a coupling with s strains that a matrix couples."""

    name: str
    motion: FloatArray
    """Strains per freedom, m or rad. Shape (s, n)."""
    stiffness: FloatArray
    """Stiffness matrix over the strains. Shape (s, s)."""


class _Spring(NamedTuple):
    """A spring of one strain."""

    name: str
    strain: FloatArray
    """Strain per freedom, m or rad. Shape (n,)."""
    stiffness: float
    """Stiffness, N/m or N m/rad."""


def _joints(system: System, time: float, tangent: FloatArray) -> Iterator[_Joint]:
    """Yield the bearings and couplings with a stiffness matrix at `time`.

    Bearings that are not linear have the slopes of their forces at the equilibrium, `tangent` (R, P).
    """
    seats, couplings, keep = system.seats, system.couplings, system.freedoms.keep
    for name, strains in seats.group:
        yield _Joint(name, keep(seats.motion[strains]), seats.stiffness[strains, strains])
    for name, motion, matrix in zip(couplings.name, couplings.motion, couplings.stiffness, strict=True):
        yield _Joint(name, keep(motion), matrix)
    n = system.arrays.mass.shape[0]
    parts = frame_couplings(system.scene)
    # behind the positions of the meshes stand the rotations, in turns; those of these couplings come first
    position = local_state(system.arrays, time, np.zeros(n), np.zeros(n)).position
    turns = position[len(system.scene.meshes) :][: len(parts)]
    for part, turn in zip(parts, turns, strict=True):
        motion, matrix = frame_joint(system.scene, system.rotors, part, 2.0 * np.pi * float(turn))
        yield _Joint(couplings.name[part.coupling], keep(motion), matrix)
    # the elements of bearings that are not linear are the last ones
    first_rows = system.arrays.elements.first[len(system.elements) - len(system.bearings) :]
    for first, bearing in zip(first_rows, system.bearings, strict=False):  # one more: the end of the rows
        size = bearing.directions.shape[0]
        rows = slice(first, first + size)
        matrix = 0.5 * (tangent[rows, :size] + tangent[rows, :size].T)
        yield _Joint(system.supports.name[bearing.support], system.arrays.direction[rows], matrix)


def _springs(system: System, time: float, tangent: FloatArray) -> list[_Spring]:
    """Return the springs of meshes, bearings, couplings, drives, and elastic shafts and housings."""
    direction, supports, freedoms = system.arrays.direction, system.supports, system.freedoms
    springs = [
        _Spring(mesh.name, direction[row], tangent[row, 0])
        for mesh, row in zip(system.scene.meshes, system.driving_rows, strict=True)
    ]
    motion = freedoms.keep(supports.motion)
    for index, name in enumerate(supports.name):
        if index not in system.seats.support:
            by_axis = zip("xyz", motion[index], supports.stiffness[index], strict=True)
            springs += [_Spring(f"{name}.{axis}", row, value) for axis, row, value in by_axis]
    for joint in _joints(system, time, tangent):
        values, vectors = np.linalg.eigh(joint.stiffness)
        principal = zip(values, vectors.T, strict=True)
        springs += [
            _Spring(joint.name, np.asarray(vector @ joint.motion), value)
            for value, vector in principal
            if value > 0.0
        ]
    for _, drive, row in drive_springs(system.scene, system.kinematics, system.rotors, freedoms):
        springs.append(_Spring(drive.name, row, drive.stiffness or 0.0))
    stiffness, _ = elastic_terms(system.rotors)
    elastic = stiffness[freedoms.column]
    unit = np.eye(elastic.size)
    springs += [_Spring(freedoms.name[i], unit[i], elastic[i]) for i in np.flatnonzero(elastic > 0.0)]
    return springs
