"""Whether tables that are read at one misalignment or center distance were right to: how far bodies moved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.forces import GearMesh
from dynamics.forces.operating_point_table import table_at_operating_point
from dynamics.mechanism.additions import MISALIGNMENT
from dynamics.mechanism.flank_gradients import distance_gradient, misalignment_gradient
from dynamics.results.axis_checks import WHAT
from dynamics.results.axis_series import FIELDS
from dynamics.types import FloatArray, Json

USUAL_TOLERANCE = 0.01
"""Relative change of the mean transmission error that may pass where no tolerance was requested."""


@dataclass(frozen=True)
class _Watched:
    """A mesh whose table has an axis that is not followed: its derivative in the freedoms (n,)."""

    axis: int
    mesh: int
    gradient: FloatArray


class HeldOperatingPointChecks:
    """Gathers, block by block, how far bodies moved along axes of tables that did not follow them."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._watched = [
            _Watched(axis, index, _gradient(system, axis, index))
            for axis, field in enumerate(FIELDS)
            for index, mesh in enumerate(system.scene.meshes)
            if any(
                row.possible and not row.on for row in system.ledger.adding(field) if row.part == mesh.name
            )
        ]
        self._range = [(0.0, 0.0)] * len(self._watched)

    def see(self, q: FloatArray) -> None:
        """Take the displacements (T, n)."""
        for k, watched in enumerate(self._watched):
            moved = q @ watched.gradient
            low, high = self._range[k]
            self._range[k] = (float(np.min(moved, initial=low)), float(np.max(moved, initial=high)))

    def found(self) -> list[Json]:
        """Return one entry per mesh and axis.

        ``farthest`` is how far the bodies moved in m, ``change`` how much that changes the mean transmission
        error of the nominal force, of its value.
        """
        pairs = zip(self._watched, self._range, strict=True)
        return [self._entry(watched, max(span, key=abs)) for watched, span in pairs]

    def _entry(self, watched: _Watched, farthest: float) -> Json:
        """One mesh and axis."""
        system, quantity = self._system, WHAT[watched.axis]
        mesh, force = system.scene.meshes[watched.mesh], float(system.flanks.nominal_force[watched.mesh])
        change = _change(mesh, force, watched.axis, farthest)
        reported = (
            f"bodies moved by up to {farthest:.3g} m, which "
            f"changes the mean by {engineering(100.0 * change, 2)} %"
        )
        return {
            "effect": system.ledger.effect_adding(FIELDS[watched.axis]),
            "assumption": f"{quantity} stays at the operating point",
            "part": mesh.name,
            "holds": abs(change) <= (system.scene.tolerance or USUAL_TOLERANCE),
            "farthest": farthest,
            "change": change,
            "reason": reported,
        }


def _change(mesh: GearMesh, force: float, axis: int, moved: float) -> float:
    """Return the relative change of the mean transmission error at `force` by `moved` (m) along an axis."""
    level = int(np.argmin(np.abs(np.asarray(mesh.table.level) - force)))
    point = np.array([mesh.misalignment, mesh.center_distance_change])
    means = [
        float(np.mean(table_at_operating_point(mesh.table, *at).deflection[..., level]))
        for at in (point, point + moved * np.eye(2)[axis])
    ]
    return means[1] / means[0] - 1.0 if means[0] != 0.0 else 0.0


def _gradient(system: System, axis: int, index: int) -> FloatArray:
    """Return the derivative of a mesh's operating point on an axis in the free freedoms, (n,)."""
    scene, rotors, line = system.scene, system.rotors, system.lines[index]
    if FIELDS[axis] == MISALIGNMENT:
        sense = system.kinematics.mesh_sense[index]
        return system.freedoms.keep(misalignment_gradient(scene, rotors, index, line, sense))
    return system.freedoms.keep(distance_gradient(scene, rotors, index, line))
