"""The outer hull of a reduced housing, and how each of its coordinates moves it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from dynamics.acoustics.air import directions
from dynamics.acoustics.hull import Hull, LinearPanels, shared_edges
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.identity_cache import identity_cached
from dynamics.kernels.compiled import compiled
from dynamics.types import BoolArray, FloatArray, IntArray
from host.optional_modules import csgraph, sparse

ORDER = 8
"""Order of the views, which come from 2 ORDER^2 = 128 directions."""
PIXELS = 512
"""Pixels of a view across the sphere about the surface."""
STEEP = 0.2
"""Least cosine between a face's normal and a view: pixels are too coarse for flatter views."""
MARGIN = 8.0
"""Pixels by which another face must be in front: a face under `STEEP` spans 5 in depth in its own pixel."""

OUTSIDE = 0.5
"""Least part of its sky that a face sees, by which it is outside."""
JOINED = 0.15
"""Least part of its sky that a face sees, by which it is outside if it is joined to a face that is: ribs and
recesses pass, walls behind a bore do not.
"""
POCKET = 0.05
"""Least mean part of its sky, by which an area among outside faces is outside too: corners of a tub pass,
inner cavities do not.
"""
QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""Nodes of the four panels of a triangle with six nodes."""


def _free_sky(corners: FloatArray) -> FloatArray:
    """Return the part of the hemisphere over each triangle from which its middle is seen, (t,), 0 to 1.

    Directions weigh by the cosine to the normal, as in the view factor to surroundings at infinity: 1 on a
    convex body, 0 in a closed cavity. `corners` (t, 3, 3) of the triangles in m are counter-clockwise from
    outside; all triangles can hide others.
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    middle = corners.reshape(-1, 3)
    middle = 0.5 * (middle.min(axis=0) + middle.max(axis=0))
    radius = float(np.linalg.norm(corners - middle, axis=2).max())
    scaled = (corners - middle) * (PIXELS / 2.0 / radius)
    visible, total = np.zeros(len(corners)), np.zeros(len(corners))
    for view, weight in zip(*directions(ORDER), strict=True):
        cosine = normal @ view
        share = np.where(cosine > STEEP, weight * cosine, 0.0)
        total += share
        visible += share * _visible(scaled, view)
    return np.asarray(visible / np.maximum(total, 1e-300))


def _visible(corners: FloatArray, view: FloatArray) -> FloatArray:
    """Return 1 for triangles whose middle an eye far away in direction `view` sees, else 0, (t,)."""
    across = np.linalg.svd(view[None])[2]  # last two rows: across the view
    axes = np.stack([across[1], across[2], view], axis=1)
    projected = np.ascontiguousarray(corners @ axes + np.array([PIXELS / 2.0, PIXELS / 2.0, 0.0]))
    nearest = np.full((PIXELS, PIXELS), -np.inf)
    _draw(projected, nearest)
    column, row, depth = projected.mean(axis=1).T
    last = PIXELS - 1
    front = nearest[np.clip(column.astype(int), 0, last), np.clip(row.astype(int), 0, last)]
    return np.where(depth >= front - MARGIN, 1.0, 0.0)


@compiled
def _draw(corners: FloatArray, nearest: FloatArray) -> None:
    """Raise `nearest` (columns, rows) to the depth of every triangle that covers the middle of a pixel."""
    for t in range(corners.shape[0]):
        ax, ay, az = corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]
        bx, by, bz = corners[t, 1, 0] - ax, corners[t, 1, 1] - ay, corners[t, 1, 2] - az
        cx, cy, cz = corners[t, 2, 0] - ax, corners[t, 2, 1] - ay, corners[t, 2, 2] - az
        area = bx * cy - by * cx
        if area == 0.0:
            continue
        low_x, high_x = max(int(ax + min(0.0, bx, cx) - 0.5), 0), min(int(ax + max(0.0, bx, cx)), PIXELS - 1)
        low_y, high_y = max(int(ay + min(0.0, by, cy) - 0.5), 0), min(int(ay + max(0.0, by, cy)), PIXELS - 1)
        for i in range(low_x, high_x + 1):
            for j in range(low_y, high_y + 1):
                x, y = i + 0.5 - ax, j + 0.5 - ay
                b, c = (x * cy - y * cx) / area, (bx * y - by * x) / area
                if b >= 0.0 and c >= 0.0 and b + c <= 1.0:
                    nearest[i, j] = max(nearest[i, j], az + b * bz + c * cz)


def _rims(triangles: IntArray) -> list[IntArray]:
    """Return the nodes along every open edge path of consistently oriented triangles, each closed."""
    starts, ends = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max()) + 1
    open_edge = ~np.isin(starts * count + ends, ends * count + starts)
    onward: dict[int, list[int]] = {}
    for start, end in zip(starts[open_edge].tolist(), ends[open_edge].tolist(), strict=True):
        onward.setdefault(start, []).append(end)
    return [rim for first in list(onward) for rim in _walk(first, onward)]


def _walk(first: int, onward: dict[int, list[int]]) -> Iterator[IntArray]:
    """Yield the rims along a walk that uses up the edges: a rim ends where the walk meets a node again.

    As many edges enter a node as leave it, so that the walk ends where it began.
    """
    path = [first]
    while onward[path[-1]]:
        node = onward[path[-1]].pop()
        if node not in path:
            path.append(node)
            continue
        start = path.index(node)
        yield np.array(path[start:])
        del path[start + 1 :]


def _cap(points: FloatArray, rim: IntArray, first: int) -> tuple[IntArray, FloatArray]:
    """Return triangles (C, 3) that close a rim, and their new nodes as weights of the rim's nodes, (K, R).

    The new nodes lie on rings, as far apart as the nodes of the rim; the last one is the middle of the rim.
    They are numbered from `first` on.
    """
    count = rim.size
    even = np.full((count, count), 1.0 / count)
    radius = np.linalg.norm(points[rim] - points[rim].mean(axis=0), axis=1).max()
    edge = np.linalg.norm(points[rim] - points[np.roll(rim, 1)], axis=1).max()
    parts = max(int(np.ceil(radius / edge)), 1)
    inward = [even * k / parts + np.eye(count) * (1.0 - k / parts) for k in range(1, parts)]
    weights = np.concatenate([*inward, even[:1]])
    rings = np.vstack([rim, first + np.arange((parts - 1) * count).reshape(parts - 1, count)])
    triangles = []
    for a, c in pairwise(rings):  # b and d: the next nodes on the rings of a and c
        b, d = np.roll(a, -1), np.roll(c, -1)
        triangles.append(np.stack([[b, a, c], [b, c, d]], axis=0).transpose(0, 2, 1).reshape(-1, 3))
    last = rings[-1]
    middle = np.full(count, first + len(weights) - 1)
    return np.concatenate([*triangles, np.stack([np.roll(last, -1), last, middle], axis=1)]), weights


@dataclass(frozen=True)
class OuterHull:
    """Outer surface of a housing, closed: without the walls of inner cavities, openings capped."""

    hull: Hull
    """Panels of outer faces, four for each face of an element, then the caps."""
    motion: FloatArray
    """Displacement of each node per reduced coordinate. Shape (N, 3, r)."""
    inner_area: float
    """Area of the inner faces, which the hull leaves out, m^2."""
    cap_area: float
    """Area of the caps over openings, m^2."""

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

    Outside are the faces that see at least half of their sky (`_free_sky`), and those joined to them that see
    at least 15 % of theirs, with pockets between them that see 5 % on average. Each opening that is left,
    e.g. in a bore, gets a cap, which moves as its rim does: bearings, covers and shaft ends are there. Raises
    `InputError`: the housing has no surface, or no face of it sees the sky.
    """
    if housing.surface is None:
        remedy = "Reduce its mesh or STEP file: matrices alone do not say what the air touches."
        raise InputError("surface", "none", "a housing with a surface", remedy)
    points, triangles = housing.surface.points, housing.surface.triangles
    outer = _outside(points, triangles)
    nodes, panels = np.unique(triangles[outer][:, QUARTERS].reshape(-1, 3), return_inverse=True)
    points, motion, panels = points[nodes], housing.surface.motion[nodes], panels.reshape(-1, 3)
    covers = [panels]
    for rim in _rims(panels):
        triangles_of_cap, weights = _cap(points, rim, len(points))
        covers.append(triangles_of_cap)
        points = np.concatenate([points, weights @ points[rim]])
        motion = np.concatenate([motion, np.tensordot(weights, motion[rim], 1)])
    hull = Hull(points, np.concatenate(covers))
    a, b, c = (housing.surface.points[triangles[~outer][:, k]] for k in range(3))
    inner_area = float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    return OuterHull(hull, motion, inner_area, float(hull.areas[len(panels) :].sum()))


def _outside(points: FloatArray, triangles: IntArray) -> BoolArray:
    sky = _free_sky(points[triangles[:, :3]])
    if not np.any(sky >= OUTSIDE):
        raise InputError("surface", float(sky.max()), f"faces that see {OUTSIDE:.0%} of their sky")
    outside = np.zeros(len(triangles), dtype=bool)
    for part in _areas(triangles, sky >= JOINED):
        outside[part] = np.any(sky[part] >= OUTSIDE)
    for pocket in _areas(triangles, ~outside):
        outside[pocket] = sky[pocket].mean() >= POCKET
    return outside


def _areas(triangles: IntArray, mask: BoolArray) -> list[IntArray]:
    """Return the areas of triangles joined by edges, among those of a mask."""
    members = np.flatnonzero(mask)
    first, second, _ = shared_edges(triangles[members, :3])
    joined = sparse.coo_array((np.ones(first.size), (first, second)), shape=(members.size,) * 2)
    count, part = csgraph.connected_components(joined)
    return [members[part == number] for number in range(count)]
