"""The outer hull of a reduced housing, and how each of its coordinates moves it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from dynamics.acoustics.hull import Hull, shared_edges
from dynamics.acoustics.linear_panels import LinearPanels
from dynamics.acoustics.rims import cap, rims
from dynamics.acoustics.sky import free_sky
from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.identity_cache import identity_cached
from dynamics.types import BoolArray, FloatArray, IntArray

OUTSIDE = 0.5
"""A face that sees this part of its sky is outside."""
JOINED = 0.15
"""So is what is joined to such a face and sees this part: ribs, recesses; walls behind a bore see less."""
POCKET = 0.05
"""So is what is left in between if it sees this part on average: corners of a tub, but no inner cavity."""
QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""Nodes of the four panels of a triangle with six nodes."""


@dataclass(frozen=True)
class OuterHull:
    """What the air outside touches: closed, walls of inner cavities left out, openings capped.

    Attributes
    ----------
    hull : Hull
        Panels of outer faces, four for each face of an element, then the caps.
    motion : (N, 3, r) array
        Displacement of each node per reduced coordinate.
    inner_area : float
        Of the faces left out, m^2.
    cap_area : float
        Of the caps, m^2.
    """

    hull: Hull
    motion: FloatArray
    inner_area: float
    cap_area: float

    @cached_property
    def shapes(self) -> FloatArray:
        """Return the mean outward displacement of the panels per reduced coordinate, (T, r)."""
        mean, normals = LinearPanels(self.hull).mean, self.hull.normals
        along = (normals[:, axis, None] * (mean @ self.motion[:, axis]) for axis in range(3))
        return np.asarray(sum(along))

    @cached_property
    def surface(self) -> FloatArray:
        """Return the integral over the hull of the products of outward displacements, (r, r), m^2."""
        return np.asarray(self.shapes.T @ (self.hull.areas[:, None] * self.shapes))


@identity_cached
def outer_hull(housing: ReducedHousing) -> OuterHull:
    """Return the outer hull of a housing.

    Outside are the faces that see at least half of their sky (`sky.free_sky`), and those joined to them that
    see at least 15 % of theirs, with pockets between them that see 5 % on average. Each opening that is left,
    e.g. in a bore, gets a cap, which moves as its rim does: bearings, covers and shaft ends are there.

    Raises
    ------
    InputError
        The housing has no surface, or no face of it sees the sky.
    """
    if housing.surface is None:
        advice = "Reduce its mesh or STEP file: matrices alone do not say what the air touches."
        raise InputError("surface", "none", "a housing with a surface", advice)
    points, triangles = housing.surface.points, housing.surface.triangles
    outer = _outside(points, triangles)
    nodes, panels = np.unique(triangles[outer][:, QUARTERS].reshape(-1, 3), return_inverse=True)
    points, motion, panels = points[nodes], housing.surface.motion[nodes], panels.reshape(-1, 3)
    covers = [panels]
    for rim in rims(panels):
        triangles_of_cap, weights = cap(points, rim, len(points))
        covers.append(triangles_of_cap)
        points = np.concatenate([points, weights @ points[rim]])
        motion = np.concatenate([motion, np.tensordot(weights, motion[rim], 1)])
    hull = Hull(points, np.concatenate(covers))
    left_out = _area(housing.surface.points, triangles[~outer])
    return OuterHull(hull, motion, left_out, float(hull.areas[len(panels) :].sum()))


def _area(points: FloatArray, triangles: IntArray) -> float:
    """Return the area of the triangles between corners, m^2."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def _outside(points: FloatArray, triangles: IntArray) -> BoolArray:
    """Return which triangles are outside, (t,)."""
    sky = free_sky(points[triangles[:, :3]])
    if not np.any(sky >= OUTSIDE):
        raise InputError("surface", float(sky.max()), f"faces that see {OUTSIDE:.0%} of their sky")
    outside = np.zeros(len(triangles), dtype=bool)
    for part in _parts(triangles, sky >= JOINED):
        outside[part] = np.any(sky[part] >= OUTSIDE)
    for part in _parts(triangles, ~outside):
        outside[part] = sky[part].mean() >= POCKET
    return outside


def _parts(triangles: IntArray, chosen: BoolArray) -> list[IntArray]:
    """Return the connected parts of chosen triangles."""
    members = np.flatnonzero(chosen)
    count, part = connected_components(_neighbors(triangles[members, :3]))
    return [members[part == number] for number in range(count)]


def _neighbors(triangles: IntArray) -> coo_array:
    """Return which triangles share an edge, (t, t)."""
    one, other, _ = shared_edges(triangles)
    return coo_array((np.ones(one.size), (one, other)), shape=(len(triangles),) * 2)
