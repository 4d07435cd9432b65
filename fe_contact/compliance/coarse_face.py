"""Elements whose lower face is half of a face of a layer that is twice as thick.

The nodes of the thin layer that are no nodes of the thick one hang on its coarse face: they follow its
functions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.hexahedron_stiffness import above, cylindrical_frames
from fe_contact.mesh.element_stack import LOWER_FACE
from fe_contact.types import FloatArray

# Nodes of a face in the order of LOWER_FACE: position along the side 0-1, and across the layer.
ALONG = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0])

ACROSS = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 0.0, 0.0])

SIDE = [0, 1, 0, 1, 4, 4, 0, 1]
"""Node of the quadrilateral below each node of a coarse face."""


@dataclass(frozen=True)
class _CoarseFace:
    """The coarse faces that hanging nodes lie on."""

    nodes: FloatArray
    """Nodes of the coarse faces, m. Shape (m, 8, 3)."""
    weights: FloatArray
    """Value of each face function (column) at each hanging node (row). Shape (8, 8)."""

    def attach(self, nodes: FloatArray) -> FloatArray:
        """Return element nodes (m, 20, 3) with the hanging nodes placed on the coarse face."""
        attached = nodes.copy()
        attached[:, LOWER_FACE] = self.weights @ self.nodes
        return attached

    def transform(self, frames: FloatArray) -> FloatArray:
        """Return the Cartesian displacements (m, 60, 60) per freedom of the nodes that exist.

        `frames` (m, 20, 3, 3) are the axes of the nodes above; those of this face are cylindrical.
        """
        # axes: element, node and Cartesian component, then node and component of the freedom
        transform = np.zeros((len(frames), 20, 3, 20, 3))
        free_nodes = np.setdiff1d(np.arange(20), LOWER_FACE)
        transform[:, free_nodes, :, free_nodes] = frames[:, free_nodes].transpose(1, 0, 2, 3)
        interpolation = (
            self.weights[:, None, :, None] * cylindrical_frames(self.nodes).transpose(0, 2, 1, 3)[:, None]
        )
        hanging = np.array(LOWER_FACE)
        transform[:, hanging[:, None], :, hanging] = interpolation.transpose(1, 3, 0, 2, 4)
        return transform.reshape(len(frames), 60, 60)


def coarse_face(section: FloatArray, thickness: float, angle: float, half: int) -> _CoarseFace:
    """Return the face that elements hang on, on its lower half (`half` -1) or its upper one (+1).

    `section` (m, 8, 2) are their section nodes at the middle of the thin layer, which turns by `angle` in
    rad, m.
    """
    # levels count from the middle of the thin layer in its thickness; the coarse face is two thicknesses high
    nodes = above(section[:, SIDE], ACROSS - 0.5 * half, thickness, angle)
    return _CoarseFace(nodes, face_functions(ALONG, 0.5 * (ACROSS + half)))


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
