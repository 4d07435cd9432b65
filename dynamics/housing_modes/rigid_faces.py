"""Freedoms of a mesh some of whose faces are rigid or fixed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from dynamics.errors import InputError
from dynamics.housing_modes.rigid_motion import rigid_motions
from dynamics.types import FloatArray, IntArray


@dataclass(frozen=True)
class RigidFace:
    """Nodes that move as one body about a point (m); `fixed` ones do not move."""

    name: str
    nodes: IntArray
    about: FloatArray
    fixed: bool = False


@dataclass(frozen=True)
class Freedoms:
    """Independent freedoms: three of each free node, then six of each rigid face.

    Attributes
    ----------
    motion : (3 n, f) sparse array
        Displacements of all nodes per freedom.
    free : int array
        The free nodes.
    faces : tuple of RigidFace
        Those that move. Six freedoms each: x, y, z, rotations about x, y, z through its point.
    """

    motion: sp.csr_array
    free: IntArray
    faces: tuple[RigidFace, ...]

    def face(self, name: str) -> IntArray:
        """Return the six freedoms of a rigid face."""
        number = [face.name for face in self.faces].index(name)
        return 3 * len(self.free) + 6 * number + np.arange(6)

    def rigid(self, points: FloatArray, about: FloatArray) -> FloatArray:
        """Return the freedoms by rigid motions of all nodes, (f, 6), see `rigid_motions`."""
        parts = [rigid_motions(points[self.free], about)]
        for face in self.faces:
            turned = np.hstack([np.zeros((3, 3)), np.eye(3)])
            parts += [rigid_motions(face.about[None], about), turned]
        return np.vstack(parts)


def independent_freedoms(points: FloatArray, faces: tuple[RigidFace, ...]) -> Freedoms:
    """Eliminate the nodes of rigid faces.

    Raises
    ------
    InputError
        Two faces share nodes.
    """
    owner = np.full(len(points), -1)
    for number, face in enumerate(faces):
        shared = owner[face.nodes]
        if np.any(shared >= 0):
            bound = f'apart from "{faces[int(shared.max())].name}"'
            raise InputError(face.name, "rigid", bound, "They share nodes: move one, or make them one face.")
        owner[face.nodes] = number
    free = np.flatnonzero(owner < 0)
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    blocks = [(np.ones(rows.size), rows, np.arange(rows.size))]
    moving = tuple(face for face in faces if not face.fixed)
    for number, face in enumerate(moving):
        values = rigid_motions(points[face.nodes], face.about)
        at = (3 * face.nodes[:, None] + np.arange(3)).ravel()
        row, column = np.broadcast_arrays(at[:, None], rows.size + 6 * number + np.arange(6))
        blocks.append((values.ravel(), row.ravel(), column.ravel()))
    value, row, column = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    motion = sp.coo_array(
        (value, (row, column)), shape=(3 * len(points), rows.size + 6 * len(moving))
    ).tocsr()
    motion.eliminate_zeros()
    return Freedoms(motion, free, moving)
