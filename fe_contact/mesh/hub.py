"""Mesh of what lies below and beside the real teeth: the rest of the ring down to the bore."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import Gear
from fe_contact.mesh.grading import divide
from fe_contact.mesh.outline import Outline, Piece, arc, piece
from fe_contact.mesh.quadratic import QuadraticMesh, rotated
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.tooth_outline import LARGEST_ARC
from fe_contact.mesh.tooth_sector import ToothSector
from fe_contact.types import FloatArray, IntArray

HALF = 0.5  # largest element of the plain ring, in parts of its thickness


@dataclass(frozen=True)
class Hub:
    """The ring without the sectors of the real teeth.

    Attributes
    ----------
    points : (n, 2) array
        Nodes, m.
    triangles : (m, 6) array
        Six-node triangles.
    bottoms : (t, b) int array
        Nodes shared with the bottom of each sector, left to right.
    right_side, left_side : int arrays
        Nodes shared with the first sector's right and the last one's left side, from the bottom up; empty
        if all teeth are real.
    bore : int array
        Nodes on the bore.
    """

    points: FloatArray
    triangles: IntArray
    bottoms: IntArray
    right_side: IntArray
    left_side: IntArray
    bore: IntArray


def hub_outlines(
    gear: Gear, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe
) -> tuple[Outline, Outline]:
    """Return the outer boundary, which follows the sectors of `teeth`, and the bore."""
    pitch = 2.0 * np.pi / gear.teeth
    # From the right end of a bottom to its left: counter-clockwise, as the teeth are numbered.
    pieces = [Piece(f"bottom {j}", rotated(sector.points[sector.bottom[::-1]], j * pitch)) for j in teeth]
    if len(teeth) < gear.teeth:
        left = Piece("left side", rotated(sector.points[sector.left_side], teeth[-1] * pitch))
        right = Piece("right side", rotated(sector.points[sector.right_side[::-1]], teeth[0] * pitch))
        pieces += [left, plain_rim(left, gear.teeth - len(teeth), pitch, gear.bore_diameter, recipe), right]
    return Outline(tuple(pieces)), bore(gear, float(np.linalg.norm(sector.points[sector.bottom[0]])), recipe)


def plain_rim(side: Piece, missing: int, pitch: float, bore_diameter: float, recipe: MeshRecipe) -> Piece:
    """Return the root circle from the end of `side` counter-clockwise over the missing teeth."""
    x, y = side.nodes[-1]
    radius, angle, length = float(np.hypot(x, y)), float(np.arctan2(x, y)), missing * pitch
    largest = min(HALF * (1.0 - 0.5 * bore_diameter / radius), LARGEST_ARC)

    def size(turned: FloatArray) -> FloatArray:
        distance = np.minimum(turned, length - turned)
        wanted: FloatArray = side.edge_lengths[-1] / radius + recipe.growth * distance
        return np.minimum(wanted, largest)

    circle = arc(radius)
    return piece("plain rim", lambda turned: circle(angle - turned), divide(0.0, length, size))


def bore(gear: Gear, bottom_radius: float, recipe: MeshRecipe) -> Outline:
    """Return the bore, clockwise."""
    radius, depth = 0.5 * gear.bore_diameter, bottom_radius - 0.5 * gear.bore_diameter
    size = min(recipe.body_size + recipe.growth * depth, HALF * depth)
    step = min(size / radius, LARGEST_ARC)
    ends = divide(0.0, 2.0 * np.pi, lambda angle: np.full_like(angle, step))
    return Outline((piece("bore", arc(radius), ends),))


def hub(mesh: QuadraticMesh, outlines: tuple[Outline, Outline], teeth: IntArray) -> Hub:
    """Name the boundary nodes of the mesh of `hub_outlines`."""
    outer, inner = mesh.boundary
    found = {p.name for p in outlines[0].pieces}

    def nodes(name: str) -> IntArray:
        return outer[outlines[0].positions(name)] if name in found else np.empty(0, dtype=np.int64)

    return Hub(
        points=mesh.points,
        triangles=mesh.triangles,
        bottoms=np.array([nodes(f"bottom {j}")[::-1] for j in teeth]),
        right_side=nodes("right side")[::-1],
        left_side=nodes("left side"),
        bore=inner,
    )
