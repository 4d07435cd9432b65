"""Elements whose lower face is half of a face of a twice as thick layer.

The nodes that hang on the coarse face are placed on it and move with it. Serendipity functions of degree two
hold those of the coarse face, so there is neither gap nor overlap: displacement is continuous, and constant
strain stays exact on helical meshes too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.hexahedron import above, cylindrical_frames
from fe_contact.mesh.swept_sector import LOWER_FACE
from fe_contact.types import FloatArray

# Nodes of a face in the order of LOWER_FACE: position along the side 0-1, and across the layer.
ALONG = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0])
ACROSS = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 0.0, 0.0])
SIDE = [0, 1, 0, 1, 4, 4, 0, 1]
"""Node of the quadrilateral that each of them stands above."""


@dataclass(frozen=True)
class CoarseFace:
    """The face that hanging nodes lie on.

    Attributes
    ----------
    nodes : (m, 8, 3) array
        Its nodes, m.
    weights : (8, 8) array
        Value of each of its functions (column) at each hanging node (row).
    """

    nodes: FloatArray
    weights: FloatArray

    def attach(self, nodes: FloatArray) -> FloatArray:
        """Return element nodes (m, 20, 3) with the hanging ones placed on this face."""
        attached = nodes.copy()
        attached[:, LOWER_FACE] = self.weights @ self.nodes
        return attached

    def transform(self, frames: FloatArray) -> FloatArray:
        """Return the Cartesian displacements (m, 60, 60) per freedom of the nodes that exist.

        `frames` (m, 20, 3, 3) are the axes of the nodes above; those of this face are cylindrical.
        """
        transform = np.zeros((len(frames), 20, 3, 20, 3))
        own = np.setdiff1d(np.arange(20), LOWER_FACE)
        transform[:, own, :, own] = frames[:, own].transpose(1, 0, 2, 3)
        moved = self.weights[:, None, :, None] * cylindrical_frames(self.nodes).transpose(0, 2, 1, 3)[:, None]
        hanging = np.array(LOWER_FACE)
        transform[:, hanging[:, None], :, hanging] = moved.transpose(1, 3, 0, 2, 4)
        return transform.reshape(len(frames), 60, 60)


def coarse_face(section: FloatArray, thickness: float, turn: float, half: int) -> CoarseFace:
    """Return the face that elements hang on.

    Parameters
    ----------
    section : (m, 8, 2) array
        Section nodes of the elements at the middle of the thin layer, m.
    thickness, turn : float
        Of the thin layer, m and rad.
    half : int
        -1: the elements are on the lower half of the coarse face; +1: on the upper half.
    """
    nodes = above(section[:, SIDE], ACROSS - 0.5 * half, thickness, turn)
    return CoarseFace(nodes, face_functions(ALONG, 0.5 * (ACROSS + half)))


def face_functions(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the eight-node serendipity functions at points (n,) of -1 .. 1, (n, 8)."""
    functions = []
    for a, b in zip(ALONG, ACROSS, strict=True):
        if a and b:
            functions.append(0.25 * (1 + a * x) * (1 + b * y) * (a * x + b * y - 1))
        elif a:
            functions.append(0.5 * (1 + a * x) * (1 - y * y))
        else:
            functions.append(0.5 * (1 - x * x) * (1 + b * y))
    return np.stack(functions, axis=-1)
