"""Mesh of what lies below and beside the real teeth: the rest of the ring down to the bore."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import Toothing
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
        Nodes on the bore, or on the outside of a ring gear's rim.
    """

    points: FloatArray
    triangles: IntArray
    bottoms: IntArray
    right_side: IntArray
    left_side: IntArray
    bore: IntArray


def hub_outlines(
    gear: Toothing, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe
) -> tuple[Outline, Outline]:
    """Return the boundary that follows the sectors of `teeth`, and the circle that the gear is held by.

    The first is the outer one, that of a ring gear the inner one.
    """
    pitch = 2.0 * np.pi / gear.teeth
    # From the right end of a bottom to its left: counter-clockwise, as the teeth are numbered.
    pieces = [Piece(f"bottom {j}", rotated(sector.points[sector.bottom[::-1]], j * pitch)) for j in teeth]
    if len(teeth) < gear.teeth:
        left = Piece("left side", rotated(sector.points[sector.left_side], teeth[-1] * pitch))
        right = Piece("right side", rotated(sector.points[sector.right_side[::-1]], teeth[0] * pitch))
        pieces += [left, plain_rim(left, gear.teeth - len(teeth), pitch, gear.held_radius, recipe), right]
    return Outline(tuple(pieces)), bore(gear, float(np.linalg.norm(sector.points[sector.bottom[0]])), recipe)


def plain_rim(side: Piece, missing: int, pitch: float, held_radius: float, recipe: MeshRecipe) -> Piece:
    """Return the root circle from the end of `side` counter-clockwise over the missing teeth."""
    x, y = side.nodes[-1]
    radius, angle, length = float(np.hypot(x, y)), float(np.arctan2(x, y)), missing * pitch
    largest = min(HALF * abs(1.0 - held_radius / radius), LARGEST_ARC)

    def size(turned: FloatArray) -> FloatArray:
        distance = np.minimum(turned, length - turned)
        wanted: FloatArray = side.edge_lengths[-1] / radius + recipe.growth * distance
        return np.minimum(wanted, largest)

    circle = arc(radius)
    return piece("plain rim", lambda turned: circle(angle - turned), divide(0.0, length, size))


def bore(gear: Toothing, bottom_radius: float, recipe: MeshRecipe) -> Outline:
    """Return the bore, or the outside of a ring gear's rim, clockwise."""
    radius, depth = gear.held_radius, abs(bottom_radius - gear.held_radius)
    size = min(recipe.body_size + recipe.growth * depth, HALF * depth)
    step = min(size / radius, LARGEST_ARC)
    ends = divide(0.0, 2.0 * np.pi, lambda angle: np.full_like(angle, step))
    return Outline((piece("bore", arc(radius), ends),))


def hub(mesh: QuadraticMesh, toothed: Outline, boundary: tuple[IntArray, ...], teeth: IntArray) -> Hub:
    """Name the nodes of the mesh of `hub_outlines`.

    Parameters
    ----------
    mesh : QuadraticMesh
        Between both outlines.
    toothed : Outline
        The one that follows the sectors.
    boundary : (int array, int array)
        Nodes of that outline, and of the circle that the gear is held by.
    teeth : (t,) int array
        Numbers of the real teeth.
    """
    around, held = boundary
    found = {p.name for p in toothed.pieces}

    def nodes(name: str) -> IntArray:
        return around[toothed.positions(name)] if name in found else np.empty(0, dtype=np.int64)

    return Hub(
        points=mesh.points,
        triangles=mesh.triangles,
        bottoms=np.array([nodes(f"bottom {j}")[::-1] for j in teeth]),
        right_side=nodes("right side")[::-1],
        left_side=nodes("left side"),
        bore=held,
    )
