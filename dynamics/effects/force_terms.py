"""Terms of forces: of one flank, and of a rotor because it, or the frame it is described in, rotates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.errors import InputError
from dynamics.forces.elements import RotatingFrameLaws
from dynamics.mechanism.line_of_action import LineOfAction, line_of_action
from dynamics.mechanism.mechanism import Mechanism
from dynamics.meshes.coast_flank import mirrored
from dynamics.meshes.mesh_table import MeshTable
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

# Terms of the force of one flank: the table it reads, what it follows, where and how it acts.


MISALIGNMENT, CENTER_DISTANCE, SLIDING = range(3)
"""Kinds of rows of a flank in space, in their order after the row of the deflection."""


@dataclass(frozen=True)
class FlankTerms:
    """A flank of the plane and what effects add to it.

    Attributes
    ----------
    table : MeshTable
        What it reads: of the plane, at one operating point.
    rows : three (k, N) arrays or None
        Gradients of each kind of row in all rotors' freedoms; None: it has none.
    follows : (int, int)
        1 where the force follows misalignment and center distance, 0 where it stays at the mesh's value.
    per_face : float
        1/(face width), 1/m; 0: the force acts at mid-face.
    friction : float
        Friction force over the transverse force of a pair.
    """

    table: MeshTable
    rows: tuple[FloatArray | None, FloatArray | None, FloatArray | None] = (None, None, None)
    follows: tuple[int, int] = (0, 0)
    per_face: float = 0.0
    friction: float = 0.0

    def with_rows(self, kind: int, gradients: FloatArray) -> FlankTerms:
        """Return the terms with the rows (k, N) of a kind."""
        first, second, third = (gradients if k == kind else row for k, row in enumerate(self.rows))
        return replace(self, rows=(first, second, third))

    def following(self, axis: int, flank: FlankInSpace, gradient: FloatArray) -> FlankTerms:
        """Return the terms with the table over its axes, of which the force follows one if it has knots."""
        table = flank.whole_table
        over = replace(self, table=table)
        if np.size((table.misalignment, table.center_distance_change)[axis]) == 1:
            return over
        first, second = (1 if k == axis else follows for k, follows in enumerate(self.follows))
        return replace(over.with_rows(axis, gradient[None, :]), follows=(first, second))


@dataclass(frozen=True)
class FlankInSpace:
    """One flank of a mesh among its bodies.

    Attributes
    ----------
    mechanism : Mechanism
    index : int
        Its mesh.
    coast : bool
        Whether it is the coast flank.
    """

    mechanism: Mechanism
    index: int
    coast: bool

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
        """Its line of action."""
        return line_of_action(self.mechanism.scene, self.index, self.sense)

    @property
    def whole_table(self) -> MeshTable:
        """The table over all its axes."""
        mesh = self.mechanism.scene.meshes[self.index]
        if not self.coast:
            return mesh.table
        if mesh.coast is None:
            raise InputError(f"meshes[{self.index}].coast", None, "given")
        return mirrored(mesh.coast.table or mesh.table, mesh.coast.thickness)


Factors = tuple[float, float, float, float, float]


@dataclass(frozen=True)
class FrameTerm:
    """A term of a rotating-frame element.

    Attributes
    ----------
    rows : (2, N) array
        Its coordinates across the axis, m, in all rotors' freedoms.
    factors : tuple of five floats
        Those of `RotatingFrameLaws`.
    load : (float, float)
        Its load, kg m.
    """

    rows: FloatArray
    factors: Factors = (0.0, 0.0, 0.0, 0.0, 0.0)
    load: tuple[float, float] = (0.0, 0.0)

    def plus(self, other: FrameTerm) -> FrameTerm:
        """Return the sum of two terms whose rows move alike."""
        a, b, c, d, e = (x + y for x, y in zip(self.factors, other.factors, strict=True))
        load = (self.load[0] + other.load[0], self.load[1] + other.load[1])
        return replace(self, factors=(a, b, c, d, e), load=load)


def frame_laws(terms: Sequence[FrameTerm], lever: float, spinning: Sequence[bool]) -> RotatingFrameLaws:
    """Lay out the laws of `terms`; `spinning` says whose shaft adds its own rotation to the spin."""
    return RotatingFrameLaws(
        np.array([term.factors for term in terms], dtype=float).reshape(-1, 5),
        np.array([term.load for term in terms], dtype=float).reshape(-1, 2),
        np.full(len(terms), lever),
        np.array(spinning, dtype=np.bool_),
    )


def frame_lever(scene: Scene) -> float:
    """Return the radius that makes lengths of tilts, m."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)
