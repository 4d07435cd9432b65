"""The mesh of one tooth sector in six-node triangles, of the outline of its right half."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.mesh.quadratic_mesh import QuadraticMesh
from fe_contact.mesh.tooth_outline import ToothOutline
from fe_contact.types import FloatArray, IntArray

MIRRORED = [0, 2, 1, 5, 4, 3]  # node order of a triangle after reflection, counter-clockwise again


@dataclass(frozen=True)
class ToothSector:
    """One pitch of the gear in the tooth frame, identical for all teeth.

    Node lists run along the boundary, corner, mid-side, corner ...
    """

    points: FloatArray
    """Nodes, m; symmetric about x = 0. Shape (n, 2)."""
    triangles: IntArray
    """Six-node triangles. Shape (m, 6)."""
    right_side: IntArray
    left_side: IntArray
    """`right_side`, `left_side`: Nodes shared with the neighbors, from the bottom to the root. The left side
    turned clockwise by one pitch is the right one.
    """
    bottom: IntArray
    """Nodes of the lower arc from left to right, both corners included."""
    flank: IntArray
    coast_flank: IntArray
    """`flank`, `coast_flank`: Nodes of the right and left flank, root to tip. Shape (k,) each."""
    s: FloatArray
    """Flank coordinate of both, m. Shape (k,)."""


def tooth_sector(half: QuadraticMesh, outline: ToothOutline) -> ToothSector:
    """Join the mesh of the right half of a sector with its mirror image."""
    (boundary,) = half.boundary
    center = boundary[outline.outline.positions("center")]
    points = half.points.copy()
    points[center, 0] = 0.0
    image = _mirror_image(len(points), center)
    others = np.setdiff1d(np.arange(len(points)), center)
    flank = boundary[outline.outline.positions("flank")]
    side = boundary[outline.outline.positions("side")]
    right_bottom = boundary[outline.outline.positions("bottom")]
    return ToothSector(
        points=np.concatenate([points, points[others] * [-1.0, 1.0]]),
        triangles=np.concatenate([half.triangles, image[half.triangles][:, MIRRORED]]),
        right_side=side,
        left_side=image[side],
        bottom=np.concatenate([image[right_bottom][:0:-1], right_bottom]),
        flank=flank,
        coast_flank=image[flank],
        s=outline.s,
    )


def _mirror_image(count: int, center: IntArray) -> IntArray:
    """Return the number of each node's mirror image; nodes on the center line are their own."""
    image = np.arange(count)
    others = np.setdiff1d(image, center)
    image[others] = count + np.arange(len(others))
    return image
