"""Checks of a run on tables that are read at one misalignment or center distance.

The operating point of a mesh is its misalignment and its change of center distance, m. Where an effect is
off, the force of a mesh does not follow the motion of its gears on one of these axes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.mechanism.additions import MISALIGNMENT
from dynamics.mechanism.flank_gradients import distance_gradient, misalignment_gradient
from dynamics.meshes import GearMesh
from dynamics.meshes.technique import table_at_operating_point
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock
from dynamics.results.histories import FIELDS
from dynamics.types import FloatArray

USUAL_TOLERANCE = 0.01
"""Relative change of the mean transmission error that may pass where no tolerance was requested."""

WHAT = ("tilt", "center distance")
"""Names of the axes in a report, in the order of `FIELDS`."""


class _Axis(NamedTuple):
    """An axis of a mesh's operating point that the force does not follow."""

    number: int
    """Index of the axis in `FIELDS`."""
    mesh: int
    """Index of the mesh."""
    gradient: FloatArray
    """Derivative of the operating point on this axis by the freedoms. Shape (n,)."""


class HeldOperatingPointChecks:
    """Motion of bodies, gathered block by block, along axes of tables that do not follow it."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._axes: list[_Axis] = []
        for axis, field in enumerate(FIELDS):
            off = {row.part for row in system.ledger.adding(field) if row.possible and not row.on}
            for index, mesh in enumerate(system.scene.meshes):
                if mesh.name in off:
                    self._axes.append(_Axis(axis, index, _gradient(system, axis, index)))
        self._range = [(0.0, 0.0)] * len(self._axes)  # lowest and highest operating point so far, m

    def see(self, _series: SeriesBlock, states: States) -> None:
        """Widen the range of the operating points by a block of states."""
        for k, axis in enumerate(self._axes):
            point = states.q @ axis.gradient[: states.q.shape[1]]
            low, high = self._range[k]
            self._range[k] = float(np.min(point, initial=low)), float(np.max(point, initial=high))

    def checks(self) -> list[Check]:
        """Return one check per mesh and axis.

        ``farthest`` is the largest motion of the bodies along the axis, m; ``change`` is the relative change
        of the mean transmission error by it, at the nominal force.
        """
        pairs = zip(self._axes, self._range, strict=True)
        return [self._check(axis.number, axis.mesh, max(span, key=abs)) for axis, span in pairs]

    def _check(self, axis: int, index: int, farthest: float) -> Check:
        system, quantity = self._system, WHAT[axis]
        mesh, force = system.scene.meshes[index], float(system.flanks.nominal_force[index])
        change = _change(mesh, force, axis, farthest)
        percent = engineering(100.0 * change, 2)
        return Check(
            effect=system.ledger.effect_adding(FIELDS[axis]),
            assumption=f"{quantity} stays at the operating point",
            part=mesh.name,
            holds=abs(change) <= (system.scene.tolerance or USUAL_TOLERANCE),
            reason=f"bodies moved by up to {farthest:.3g} m, which changes the mean by {percent} %",
            figures={"farthest": farthest, "change": change},
        )


def _change(mesh: GearMesh, force: float, axis: int, shift: float) -> float:
    """Return the relative change of the mean transmission error at `force` by `shift` (m) along an axis."""
    level = int(np.argmin(np.abs(np.asarray(mesh.table.level) - force)))
    point = np.array([mesh.misalignment, mesh.center_distance_change])
    shifted = point + shift * np.eye(2)[axis]
    tables = [table_at_operating_point(mesh.table, *at) for at in (point, shifted)]
    means = [float(np.mean(table.deflection[..., level])) for table in tables]
    return means[1] / means[0] - 1.0 if means[0] != 0.0 else 0.0


def _gradient(system: System, axis: int, index: int) -> FloatArray:
    """Return the derivative of a mesh's operating point on an axis in the free freedoms, (n,)."""
    scene, rotors, line = system.scene, system.rotors, system.lines[index]
    if FIELDS[axis] == MISALIGNMENT:
        sense = system.kinematics.mesh_sense[index]
        return system.freedoms.keep(misalignment_gradient(scene, rotors, index, line, sense))
    return system.freedoms.keep(distance_gradient(scene, rotors, index, line))
