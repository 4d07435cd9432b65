"""The hub of a gear's mesh: the ring below and between the real teeth, down to the bore.

Real teeth are meshed as sectors (t of them, each with b nodes on its bottom); the others are left out, and
the plain rim, a piece of the root circle, replaces them. The hub of a ring gear reaches outwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.mesh.curve_division import divide
from fe_contact.mesh.outline import Outline, Piece, arc, piece
from fe_contact.mesh.quadratic_mesh import QuadraticMesh, rotated
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.tooth_outline import LARGEST_ARC
from fe_contact.mesh.tooth_sector import ToothSector
from fe_contact.types import FloatArray, IntArray

_ELEMENT_SHARE = 0.5  # largest element of a plain ring over the thickness of the ring


@dataclass(frozen=True)
class Hub:
    """The ring without the sectors of the real teeth."""

    points: FloatArray
    """Nodes, m. Shape (n, 2)."""
    triangles: IntArray
    """Six-node triangles. Shape (m, 6)."""
    bottoms: IntArray
    """Nodes shared with the bottom of each sector, left to right. Shape (t, b)."""
    right_side: IntArray
    left_side: IntArray
    """`right_side`, `left_side`: Nodes shared with the first sector's right and the last one's left side,
    from the bottom up; empty if all teeth are real.
    """
    bore: IntArray
    """Nodes on the bore, or on the outside of a ring gear's rim."""
    thickness: FloatArray
    """Axial thickness of each element over the face width: below 1 in a web. Shape (m,)."""


@dataclass(frozen=True)
class _InnerRing:
    """A ring of the hub."""

    circle: Outline
    """The end of the ring away from the teeth."""
    thickness: float
    """Axial thickness over the face width."""


def hub_outline(gear: Toothing, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe) -> Outline:
    """Return the boundary of the hub along the sectors of `teeth`; that of a ring gear is the inner one."""
    pitch = 2.0 * np.pi / gear.teeth
    # From the right end of a bottom to its left: counter-clockwise, as the teeth are numbered.
    pieces = [Piece(f"bottom {j}", rotated(sector.points[sector.bottom[::-1]], j * pitch)) for j in teeth]
    if len(teeth) < gear.teeth:
        left = Piece("left side", rotated(sector.points[sector.left_side], teeth[-1] * pitch))
        right = Piece("right side", rotated(sector.points[sector.right_side[::-1]], teeth[0] * pitch))
        rim = _plain_rim(left, gear.teeth - len(teeth), pitch, gear.rim_inside_radius, recipe)
        pieces += [left, rim, right]
    return Outline(tuple(pieces))


def _plain_rim(side: Piece, missing: int, pitch: float, inside: float, recipe: MeshRecipe) -> Piece:
    """Return the root circle from the end of `side` counter-clockwise over the missing teeth."""
    x, y = side.nodes[-1]
    radius, length = float(np.hypot(x, y)), missing * pitch
    angle = float(np.arctan2(x, y))  # from the y axis, the middle of tooth 0, clockwise
    largest = min(_ELEMENT_SHARE * abs(1.0 - inside / radius), LARGEST_ARC)

    def size(turned: FloatArray) -> FloatArray:
        distance = np.minimum(turned, length - turned)
        target: FloatArray = side.edge_lengths[-1] / radius + recipe.growth * distance
        return np.minimum(target, largest)

    circle = arc(radius)
    return piece("plain rim", lambda turned: circle(angle - turned), divide(0.0, length, size))


def inner_rings(gear: Toothing, bottom_radius: float, recipe: MeshRecipe) -> tuple[_InnerRing, ...]:
    """Return the rings below the sectors: one ring, or the rest of the rim, web and hub."""
    seat_radius, web = gear.seat_radius, gear.web
    radii, thickness = [bottom_radius, seat_radius], [1.0]
    if web is not None:
        radii = [bottom_radius, web.outer_radius, web.inner_radius]
        thickness = [1.0, web.thickness / gear.face_width]
        if web.inner_radius > seat_radius:
            radii, thickness = [*radii, seat_radius], [*thickness, 1.0]
    # a circle lies between two rings; none lies behind the last circle
    depths = [*(abs(a - b) for a, b in pairwise(radii)), np.inf]
    rings = []
    for radius, neighbors, part in zip(radii[1:], pairwise(depths), thickness, strict=True):
        circle = _divided_circle(radius, min(neighbors), abs(bottom_radius - radius), recipe)
        rings.append(_InnerRing(circle, part))
    return tuple(rings)


def _divided_circle(radius: float, depth: float, distance: float, recipe: MeshRecipe) -> Outline:
    """Return a circle, clockwise; `depth` of the thinner ring beside it, `distance` from the sectors, m."""
    size = min(recipe.body_size + recipe.growth * distance, _ELEMENT_SHARE * depth)
    step = min(size / radius, LARGEST_ARC)
    ends = divide(0.0, 2.0 * np.pi, lambda angle: np.full_like(angle, step))
    return Outline((piece("circle", arc(radius), ends),))


def joined_hub(
    meshes: Sequence[QuadraticMesh],
    toothed: Outline,
    thickness: Sequence[float],
    teeth: IntArray,
    sign: int = 1,
) -> Hub:
    """Join the meshes of the rings, from the sectors to the circle that the gear is held by.

    `toothed` is the outline that follows the sectors of `teeth` (t,), the inner one where `sign` is -1 (ring
    gear); `thickness` is that of the rings over the face width.
    """
    mesh = meshes[0]
    parts = [np.full(len(mesh.triangles), thickness[0])]
    for ring, thick in zip(meshes[1:], thickness[1:], strict=True):
        mesh = _joined_mesh(mesh, ring)
        parts.append(np.full(len(ring.triangles), thick))
    around, inner = mesh.boundary[::sign]
    names = {p.name for p in toothed.pieces}

    def nodes(name: str) -> IntArray:
        return around[toothed.positions(name)] if name in names else np.empty(0, dtype=np.int64)

    return Hub(
        points=mesh.points,
        triangles=mesh.triangles,
        bottoms=np.array([nodes(f"bottom {j}")[::-1] for j in teeth]),
        right_side=nodes("right side")[::-1],
        left_side=nodes("left side"),
        bore=inner,
        thickness=np.concatenate(parts),
    )


def _joined_mesh(outside: QuadraticMesh, inside: QuadraticMesh) -> QuadraticMesh:
    """Join two meshes along the inner boundary of `outside` and the outer boundary of `inside`.

    The two boundaries have the same nodes.
    """
    seam = inside.boundary[0]
    added = np.ones(len(inside.points), dtype=bool)
    added[seam] = False
    number = np.empty(len(added), dtype=np.int64)  # of the nodes of `inside` in the joined mesh
    number[added] = len(outside.points) + np.arange(int(added.sum()))
    # the two run in opposite senses from the same node, which reversal makes the last and `roll` the first
    number[seam] = np.roll(outside.boundary[1][::-1], 1)
    return QuadraticMesh(
        points=np.concatenate([outside.points, inside.points[added]]),
        triangles=np.concatenate([outside.triangles, number[inside.triangles]]),
        boundary=(outside.boundary[0], number[inside.boundary[1]]),
    )
