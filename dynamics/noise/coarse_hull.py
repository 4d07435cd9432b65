"""A hull with fewer panels, for models whose cost grows with the square of their number.

A cell is the part of the surface around a seed. Its node lies where the planes of its faces meet best.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from dynamics.acoustics import Hull, OuterHull
from dynamics.acoustics.hull import PANELS_PER_WAVELENGTH, ROUNDED_DOWN, flat_triangles
from dynamics.identity_cache import identity_cached
from dynamics.types import BoolArray, FloatArray, IntArray

STEPS = 6
"""Times that seeds move to the middle of their cells; further steps change the longest edge by below 5 %."""
FLAT = 0.02
"""Eigenvalue, relative to the largest, below which faces do not say where along its direction a node lies."""
FARTHEST = 1.0
"""Distance from the middle of a cell to its node, over the largest distance from the middle to a node of the
surface.
"""

THIN = 0.05
"""Height over longest edge below which a panel is thin."""
ROUNDS = 4
"""A row of nodes on a straight edge needs several exchanges."""
LONGEST = 2.0
"""Longest edge of a coarse hull over its mean distance of nodes."""
ATTEMPTS = 16
"""Most attempts to split cells; walls of gear cases took up to six."""
FEWER = 0.5
"""Nodes of a coarse hull over those of the fine one, at most: otherwise the fine one is taken."""


def surface_cells(hull: Hull, count: int) -> IntArray:
    """Return the cell of every node, (N,), numbers from 0 on; at most `count` of about the same size."""
    share = _node_areas(hull)
    maximum = min(count, int(np.count_nonzero(share)))
    seeds = np.random.default_rng(0).choice(len(share), maximum, replace=False, p=share / share.sum())
    return settled_cells(hull, seeds, STEPS)


def split_cells(hull: Hull, cell: IntArray, chosen: BoolArray) -> IntArray:
    """Return the cell of every node, (N,), where each of the `chosen` (C,) cells has become two."""
    middle = _means(cell, _node_areas(hull), hull.nodes)
    distance = np.linalg.norm(hull.nodes - middle[cell], axis=1)
    nearest, farthest = _first_nodes(cell, distance), _first_nodes(cell, -distance)
    return settled_cells(hull, np.union1d(nearest, farthest[chosen]), 1)


def _cell_positions(hull: Hull, cell: IntArray) -> FloatArray:
    """Return a node for each cell, next to the planes of all its panels, m: edges and corners stay sharp."""
    count, owner = int(cell.max()) + 1, cell[hull.triangles].ravel()
    planes, offset = np.zeros((count, 3, 3)), np.zeros((count, 3))
    weighted = np.repeat(hull.area_vectors, 3, axis=0)
    normals = np.repeat(hull.normals, 3, axis=0)
    np.add.at(planes, owner, weighted[:, :, None] * normals[:, None])
    middle = _means(cell, _node_areas(hull), hull.nodes)
    height = np.sum(normals * (np.repeat(hull.centers, 3, axis=0) - middle[owner]), axis=1)
    np.add.at(offset, owner, weighted * height[:, None])
    step = np.einsum("cij,cj->ci", np.linalg.pinv(planes, rcond=FLAT, hermitian=True), offset)
    reach = np.zeros(count)
    np.maximum.at(reach, cell, np.linalg.norm(hull.nodes - middle[cell], axis=1))
    near = np.linalg.norm(step, axis=1) <= FARTHEST * reach
    return middle + np.where(near[:, None], step, 0.0)


def _nearest_nodes(hull: Hull, cell: IntArray, positions: FloatArray) -> IntArray:
    """Return the node of each cell next to a position of each, (C,)."""
    return _first_nodes(cell, np.linalg.norm(hull.nodes - positions[cell], axis=1))


def _first_nodes(cell: IntArray, value: FloatArray) -> IntArray:
    """Return the node of the least value in each cell, (C,)."""
    order = np.lexsort((value, cell))
    return np.asarray(order[np.unique(cell[order], return_index=True)[1]])


def settled_cells(hull: Hull, seeds: IntArray, steps: int) -> IntArray:
    """Return the cells of seeds after repeated moves to the middle of their cells."""
    starts, ends = hull.triangles.ravel(), np.roll(hull.triangles, -1, axis=1).ravel()
    pairs = np.unique(np.sort(np.stack([starts, ends], axis=1), axis=1), axis=0)
    length = np.linalg.norm(hull.nodes[pairs[:, 0]] - hull.nodes[pairs[:, 1]], axis=1)
    edges = coo_array((length, (pairs[:, 0], pairs[:, 1])), shape=(len(hull.nodes),) * 2).tocsr()
    share = _node_areas(hull)
    for _ in range(steps):
        cell = _next_seed(edges, seeds)
        seeds = _nearest_nodes(hull, cell, _means(cell, share, hull.nodes))
    return np.unique(_next_seed(edges, seeds), return_inverse=True)[1]


def _next_seed(edges: csr_array, seeds: IntArray) -> IntArray:
    """Return the number of the next seed of every node; parts of the surface without a seed are one cell."""
    _, _, source = dijkstra(edges, directed=False, indices=seeds, min_only=True, return_predecessors=True)
    number = np.full(edges.shape[0], len(seeds))  # number of the nodes that no seed reaches
    number[seeds] = np.arange(len(seeds))
    reached = source >= 0  # a negative number of scipy's says that no seed is connected
    cell = np.where(reached, number[np.where(reached, source, 0)], len(seeds))
    return np.unique(cell, return_inverse=True)[1]


def _node_areas(hull: Hull) -> FloatArray:
    """Return a third of the areas of the panels about each node, (N,), m^2."""
    shares = np.repeat(hull.areas / 3.0, 3)
    return np.asarray(np.bincount(hull.triangles.ravel(), shares, len(hull.nodes)), dtype=float)


def _means(cell: IntArray, weight: FloatArray, values: FloatArray) -> FloatArray:
    """Return the weighted means of values (N, 3) over each cell, (C, 3)."""
    total = np.maximum(np.bincount(cell, weight), 1e-300)
    return np.stack([np.bincount(cell, weight * values[:, axis]) / total for axis in range(3)], axis=1)


def _without_thin(nodes: FloatArray, triangles: IntArray) -> IntArray:
    """Return triangles (T, 3) in which thin ones share their longest edge no more.

    A thin triangle and the one beyond its longest edge form a quadrilateral, which gets its other diagonal.
    What was closed stays closed.
    """
    result = np.array(triangles)
    for _ in range(ROUNDS):
        turned, thin = _longest_first(nodes, result)
        if not np.any(thin):
            break
        _exchange(turned, result, np.flatnonzero(thin))
    return result


def _longest_first(nodes: FloatArray, triangles: IntArray) -> tuple[IntArray, BoolArray]:
    """Return triangles turned so that their longest edge comes first, and which are thin."""
    length = np.linalg.norm(nodes[np.roll(triangles, -1, axis=1)] - nodes[triangles], axis=2)
    first = np.argmax(length, axis=1)
    turned = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    a, b, c = np.moveaxis(nodes[turned], 1, 0)
    height = np.linalg.norm(np.cross(b - a, c - a), axis=1) / length.max(axis=1)
    return turned, height < THIN * length.max(axis=1)


def _exchange(turned: IntArray, result: IntArray, thin: IntArray) -> None:
    """Exchange the diagonals of thin triangles with their neighbors, each of which takes part once."""
    beyond = {
        (int(nodes[k]), int(nodes[(k + 1) % 3])): (index, int(nodes[(k + 2) % 3]))
        for index, nodes in enumerate(result)
        for k in range(3)
    }
    done: set[int] = set()
    for index in thin.tolist():
        p, q, top = (int(node) for node in turned[index])
        other, far = beyond.get((q, p), (index, top))
        if index in done or other in done or far == top or other == index:
            continue
        if (top, far) in beyond or (far, top) in beyond:
            continue  # the new diagonal is an edge already
        result[index], result[other] = (top, p, far), (top, far, q)
        beyond[top, far] = beyond[far, top] = (index, p)  # an edge from now on
        done |= {index, other}


@dataclass(frozen=True)
class Coarseness:
    """Coarseness of a hull: least longest edges in a wavelength, least cells for the shape of a body."""

    edges: float = PANELS_PER_WAVELENGTH
    cells: int = 800


OF_PANELS = Coarseness()
"""Coarseness for models by panels: with 800 cells a sphere loses 1 % of its volume, 0.1 dB as a dipole."""


@dataclass(frozen=True)
class RadiatingHull:
    """Panels and their motion: `shapes` (T, r), mean outward displacement per reduced coordinate."""

    hull: Hull
    shapes: FloatArray


@identity_cached
def radiating_hull(
    outer: OuterHull, highest_frequency: float, sound_speed: float, coarseness: Coarseness = OF_PANELS
) -> RadiatingHull:
    """Return a coarse closed hull that resolves a frequency in Hz; the fine one if that is hardly finer.

    Cells are split where edges come out too long, or where the hull meets itself around a thin part.
    """
    fine, maximum = RadiatingHull(outer.hull, outer.shapes), FEWER * len(outer.hull.nodes)
    longest = sound_speed / highest_frequency / coarseness.edges * ROUNDED_DOWN
    count = max(
        int(np.ceil(outer.hull.area / (0.5 * np.sqrt(3.0) * (longest / LONGEST) ** 2))), coarseness.cells
    )
    if count >= maximum:
        return fine
    cell = surface_cells(outer.hull, count)
    for _ in range(ATTEMPTS):
        coarse, owner = _coarse_hull(outer, cell)
        poor = np.concatenate([coarse.hull.open_edges, coarse.hull.longer_edges(longest)])
        if not poor.size:
            return coarse
        cell = split_cells(outer.hull, cell, np.isin(np.arange(cell.max() + 1), owner[poor]))
        if cell.max() >= maximum:
            break
    return fine


def _coarse_hull(outer: OuterHull, cell: IntArray) -> tuple[RadiatingHull, IntArray]:
    """Return a hull that has a node for each cell of the nodes, and the cell of each of its nodes.

    A cell, which lies along the surface so that thin walls stay apart, becomes the node nearest to the
    planes of its panels: edges stay sharp. Where three cells meet there is a panel. It moves as the surface
    does next to its corners; a uniform velocity restores the volume that each coordinate displaces, on which
    sound of long waves depends. Cells that meet fewer than two others have no node.
    """
    hull = outer.hull
    triangles = cell[hull.triangles]
    has_area = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
    used, corners = np.unique(triangles[has_area], return_inverse=True)
    nodes = _cell_positions(hull, cell)
    near = _nearest_nodes(hull, cell, nodes)[used]
    corners = _without_thin(nodes[used], corners.reshape(-1, 3))
    coarse = Hull(nodes[used], corners[~flat_triangles(nodes[used], corners)])
    shapes = OuterHull(coarse, outer.motion[near], 0.0, 0.0).shapes
    lost = hull.areas @ outer.shapes - coarse.areas @ shapes
    return RadiatingHull(coarse, shapes + lost / coarse.area), used
