"""The surface of the tooth root in a mesh, from the middle of the tooth space to the form point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.quadratic import SIDES
from fe_contact.mesh.tooth_sector import ToothSector
from fe_contact.types import FloatArray, IntArray

SAMPLES = 4001  # of the exact profile that nodes are sought on


@dataclass(frozen=True)
class RootSurface:
    """Both root fillets of one tooth, each with its half of the root land.

    Attributes
    ----------
    nodes : (2, 2e + 1) int array
        Nodes of the transverse section from the middle of the tooth space up to the form point: corner,
        mid-side, corner ... First the side of the loaded (right) flank, then the other.
    s : (2e + 1,) array
        Flank coordinate of both, m, increasing.
    """

    nodes: IntArray
    s: FloatArray


def triangle_root(sector: ToothSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of six-node triangles; it is found by walking along the boundary."""
    form = int(np.argmin(np.abs(sector.s[::2] - profile.s_form)))
    ahead = _boundary(sector.triangles)
    back = {after: (middle, before) for before, (middle, after) in ahead.items()}
    if profile.gear.sign < 0:  # teeth that point inwards
        ahead, back = back, ahead
    right = _walk(ahead, int(sector.right_side[-1]), int(sector.flank[2 * form]))
    left = _walk(back, int(sector.left_side[-1]), int(sector.coast_flank[2 * form]))
    return RootSurface(np.array([right, left]), flank_coordinate(profile, sector.points[right]))


def quad_root(section: QuadSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of eight-node quadrilaterals."""
    grid = section.grid
    land = grid.number[2 * grid.body_rows]
    tooth = grid.number[2 * grid.body_rows : 2 * (grid.body_rows + _below_form(section, profile)) + 1]
    low, high = 2 * grid.land, 2 * (grid.land + grid.across)
    right = np.concatenate([land[:low], tooth[:, low]])
    left = np.concatenate([land[:high:-1], tooth[:, high]])
    return RootSurface(np.array([right, left]), flank_coordinate(profile, section.points[right]))


def flank_coordinate(profile: FlankProfile, points: FloatArray) -> FloatArray:
    """Return the flank coordinates (n,) in m of points (n, 2) on the root of the right flank.

    The nearest sample of the exact profile, then along its tangent: good to the square of the sample's
    distance over the radius of curvature.
    """
    samples = np.linspace(profile.s_space, profile.s_form, SAMPLES)
    curve = profile.flank(samples)
    nearest = np.argmin(np.linalg.norm(points[:, None] - curve, axis=2), axis=1)
    normal = profile.normal(samples[nearest])
    tangent = profile.gear.sign * np.stack([-normal[:, 1], normal[:, 0]], axis=1)  # towards the tip
    along = np.sum((points - curve[nearest]) * tangent, axis=1)
    return np.asarray(samples[nearest] + along)


def _below_form(section: QuadSector, profile: FlankProfile) -> int:
    return int(np.argmin(np.abs(section.s[::2] - profile.s_form)))


def _boundary(triangles: IntArray) -> dict[int, tuple[int, int]]:
    """Return the middle and the end of the boundary edge that begins at each corner, counter-clockwise."""
    edges = np.concatenate([triangles[:, [*side, 3 + i]] for i, side in enumerate(SIDES)])
    ends = np.sort(edges[:, :2], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    return {int(a): (int(middle), int(b)) for a, b, middle in edges[first[count == 1]]}


def _walk(following: dict[int, tuple[int, int]], start: int, stop: int) -> list[int]:
    """Return the nodes from one corner of the boundary to another."""
    nodes = [start]
    while nodes[-1] != stop:
        nodes += following[nodes[-1]]
    return nodes
