"""Rotors and meshes as their effects assess them: each on its supports, under its nominal force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dynamics.mechanism.connections import Connections, elastic_matrices
from dynamics.mechanism.flank_gradients import approach, distance_gradient, misalignment_gradient
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.mean_forces import mean_forces
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.rotor import Rotor
from dynamics.meshes.gear_mesh import GearMesh
from dynamics.shafts.shaft import OnShaft
from dynamics.types import FloatArray


@dataclass(frozen=True)
class _MeshOnRotor:
    """A mesh as its rotor feels it."""

    force: float
    """Nominal transverse mesh force, N."""
    lever: float
    """Axial distance from the rotor's center of mass, m."""
    axial: float
    """Axial over transverse force, tan(base helix angle), >= 0."""
    radius: float
    """Operating pitch radius, m: the axial force's lever across the shaft."""
    direction: tuple[float, float]
    """Unit vector across the axis of the force on the rotor, along x and y."""


@dataclass(frozen=True)
class LoadedRotor:
    """A rotor of a mechanism under the nominal mesh forces."""

    mechanism: Mechanism
    flanks: Flanks
    index: int
    meshes: tuple[_MeshOnRotor, ...]

    @property
    def rotor(self) -> Rotor:
        """The rotor itself."""
        return self.mechanism.rotors[self.index]

    @property
    def resultant(self) -> float:
        """Resultant across the axis of all nominal mesh forces, N: around a sun they cancel."""
        along_x, along_y = (sum(mesh.force * mesh.direction[k] for mesh in self.meshes) for k in (0, 1))
        return math.hypot(along_x, along_y)

    @property
    def load_levers(self) -> tuple[float, ...]:
        """Distances along the axis from the rotor's center of mass to its lateral forces and unbalances, m.

        Weight acts at 0.
        """
        scene, body = self.mechanism.scene, self.rotor
        across = [part for part in scene.forces if any((*part.force[:2], *part.moment[:2]))]
        parts: list[OnShaft] = [*across, *scene.unbalances]
        at = [part.position for part in parts if part.shaft == body.shaft.name]
        weight = (0.0,) if any(scene.gravity[:2]) else ()
        return (*(body.shaft.origin[2] + position - float(body.center[2]) for position in at), *weight)


def loaded_rotors(mechanism: Mechanism, flanks: Flanks) -> tuple[LoadedRotor, ...]:
    """Return all rotors; a carrier feels the meshes of its planets at their pins."""
    scene, rotors = mechanism.scene, mechanism.rotors
    meshes: list[list[_MeshOnRotor]] = [[] for _ in rotors]
    for mesh, line, force in zip(scene.meshes, mechanism.lines, mechanism.nominal_force, strict=True):
        for name, sign in ((mesh.driver, -1.0), (mesh.driven, 1.0)):
            gear = scene.gear(name)
            index = scene.shaft_index(gear.shaft)
            lever = float(line.point[2] - rotors[index].center[2])
            radius = gear.base_radius / math.cos(line.working_pressure_angle)
            axial = abs(float(line.force[2]))
            direction = (sign * float(line.force[0]), sign * float(line.force[1]))
            meshes[index].append(_MeshOnRotor(float(force), lever, axial, radius, direction))
            carrier = rotors[index].carrier
            if carrier is not None:
                arm = rotors[index].center - rotors[carrier].center
                radius = float(np.hypot(arm[0], arm[1]))
                meshes[carrier].append(_MeshOnRotor(float(force), float(arm[2]), axial, radius, direction))
    return tuple(
        LoadedRotor(mechanism, flanks, index, tuple(on_rotor)) for index, on_rotor in enumerate(meshes)
    )


@dataclass(frozen=True)
class LoadedTrain:
    """A mechanism with its freedoms under the nominal mesh forces."""

    mechanism: Mechanism
    freedoms: Freedoms
    connections: Connections
    flanks: Flanks

    @property
    def meshes(self) -> tuple[LoadedMesh, ...]:
        """All meshes."""
        return tuple(LoadedMesh(self, index) for index in range(len(self.mechanism.scene.meshes)))

    def bends(self, gradient: FloatArray) -> FloatArray:
        """Return a gradient (N,) in the freedoms that do not turn or twist."""
        return self.freedoms.keep(gradient)[~self.freedoms.turns]

    @cached_property
    def compliance(self) -> FloatArray:
        """Displacements and tilts per force and moment on supports and shafts, in m, rad, N."""
        freedoms, supports, bends = self.freedoms, self.connections.supports, ~self.freedoms.turns
        moves = freedoms.keep(supports.motion)
        of_bodies, _ = elastic_matrices(self.mechanism.rotors, freedoms)
        stiffness = supports.matrix(supports.stiffness, moves, moves) + of_bodies
        return np.asarray(np.linalg.pinv(stiffness[np.ix_(bends, bends)]))

    @cached_property
    def mean_force(self) -> FloatArray:
        """Forces that balance loads and imposed accelerations, (m, T), N; < 0: the coast flank's."""
        return mean_forces(self.mechanism)


@dataclass(frozen=True)
class LoadedMesh:
    """A mesh of a train."""

    train: LoadedTrain
    index: int

    @property
    def mesh(self) -> GearMesh:
        """The mesh itself."""
        return self.train.mechanism.scene.meshes[self.index]

    @property
    def force(self) -> float:
        """Nominal transverse force, N."""
        return float(self.train.flanks.nominal_force[self.index])

    @property
    def stiffness(self) -> float:
        """Tangent stiffness, mean over the positions, N/m."""
        return float(self.train.flanks.mean_stiffness[self.index])

    @property
    def level(self) -> int:
        """Load level of the table nearest to the nominal force."""
        return int(np.argmin(np.abs(np.asarray(self.mesh.table.level) - self.force)))

    @cached_property
    def axes(self) -> tuple[FloatArray, FloatArray]:
        """Derivatives of misalignment and center distance in the freedoms that do not turn, (b,) each."""
        mechanism, index = self.train.mechanism, self.index
        scene, rotors, line = mechanism.scene, mechanism.rotors, mechanism.lines[index]
        sense = mechanism.kinematics.mesh_sense[index]
        tilts = misalignment_gradient(scene, rotors, index, line, sense)
        return self.train.bends(tilts), self.train.bends(distance_gradient(scene, rotors, index, line))

    def moves(self, axis: int) -> bool:
        """Whether freedoms change the misalignment (0) or the center distance (1)."""
        return bool(np.any(self.axes[axis] != 0.0))

    def fixed_axes_reason(self) -> str | None:
        """Reason why the table cannot be read along its axes as bodies move; None where it can."""
        if self.mesh.technique != "variable_torque":
            return "the constant-torque technique has one stiffness per position"
        if getattr(self.mesh.table, "deflection_derivative", None) is None:
            return "the table has no derivatives along its axes"
        return None

    def change_along(self, axis: int) -> float:
        """Return the change of the mean transmission error as the nominal force moves the bodies, m.

        `axis` is that of the table along which they move: misalignment (0) or center distance (1).
        """
        mesh, mechanism = self.mesh, self.train.mechanism
        pushed = approach(mechanism.scene, mechanism.rotors, self.index, mechanism.lines[self.index])
        shift = -self.force * float(self.axes[axis] @ self.train.compliance @ self.train.bends(pushed))
        knots = np.asarray((mesh.table.misalignment, mesh.table.center_distance_change)[axis], dtype=float)
        at = (mesh.misalignment, mesh.center_distance_change)[axis]
        mean = np.mean(np.asarray(mesh.table.deflection)[..., self.level], axis=-1)
        along = mean.mean(axis=1 - axis)
        return float(abs(np.interp(at + shift, knots, along) - np.interp(at, knots, along)))
