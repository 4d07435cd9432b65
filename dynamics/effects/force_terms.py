"""Terms of the force of one flank: its table, the motions that it follows, its point of action."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.errors import InputError
from dynamics.mechanism.line_of_action import LineOfAction, line_of_action
from dynamics.mechanism.mechanism import Mechanism
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.technique import mirrored
from dynamics.types import FloatArray

MISALIGNMENT, CENTER_DISTANCE, SLIDING = range(3)
"""Kinds of rows of a flank in space, in their order after the row of the deflection."""


@dataclass(frozen=True)
class FlankTerms:
    """A flank of the plane, and the terms that effects add to it."""

    table: MeshTable
    """Table of the flank, at one operating point."""
    rows: tuple[FloatArray | None, FloatArray | None, FloatArray | None] = (None, None, None)
    """Gradients of each kind of row in all rotors' freedoms; None: it has none. Three (k, N) arrays."""
    follows: tuple[int, int] = (0, 0)
    """Whether the force follows misalignment and center distance (1), or stays at the mesh's value (0)."""
    per_face: float = 0.0
    """1/(face width), 1/m; 0: the force acts at mid-face."""
    friction: float = 0.0
    """Friction force over the transverse force of a pair."""

    def with_rows(self, kind: int, gradients: FloatArray) -> FlankTerms:
        """Return the terms with the rows (k, N) of a kind."""
        first, second, third = (gradients if k == kind else row for k, row in enumerate(self.rows))
        return replace(self, rows=(first, second, third))

    def following(self, axis: int, flank: FlankInSpace, gradient: FloatArray) -> FlankTerms:
        """Return the terms with the table over its axes, of which the force follows one if it has knots."""
        table = flank.complete_table
        over = replace(self, table=table)
        if np.size((table.misalignment, table.center_distance_change)[axis]) == 1:
            return over
        first, second = (1 if k == axis else follows for k, follows in enumerate(self.follows))
        return replace(over.with_rows(axis, gradient[None, :]), follows=(first, second))


@dataclass(frozen=True)
class FlankInSpace:
    """One flank of a mesh among its bodies."""

    mechanism: Mechanism
    index: int
    """Index of the mesh in the scene."""
    coast: bool
    """Whether the flank is the coast flank."""

    @property
    def driving(self) -> int:
        """Sense about +z in which the driving flank pushes, +1 or -1."""
        return self.mechanism.kinematics.mesh_sense[self.index]

    @property
    def sense(self) -> int:
        """Sense about +z in which the flank pushes, +1 or -1."""
        return -self.driving if self.coast else self.driving

    @property
    def line(self) -> LineOfAction:
        """Line of action of the flank."""
        return line_of_action(self.mechanism.scene, self.index, self.sense)

    @property
    def complete_table(self) -> MeshTable:
        """The table over all its axes."""
        mesh = self.mechanism.scene.meshes[self.index]
        if not self.coast:
            return mesh.table
        if mesh.coast is None:
            raise InputError(f"meshes[{self.index}].coast", None, "given")
        return mirrored(mesh.coast.table or mesh.table, mesh.coast.thickness)
