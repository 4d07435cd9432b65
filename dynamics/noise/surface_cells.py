"""Cells of a surface: nodes next to seeds, by the distance along the surface."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from dynamics.acoustics import Hull
from dynamics.types import BoolArray, FloatArray, IntArray

STEPS = 6
"""Times that seeds move to the middle of their cells; further steps change the longest edge by below 5 %."""
FLAT = 0.02
"""Eigenvalue, relative to the largest, below which faces do not say where along its direction a node lies."""
FARTHEST = 1.0
"""From the middle of a cell to its node, over the largest distance of the middle to a node of the surface."""


def surface_cells(hull: Hull, count: int) -> IntArray:
    """Return the cell of every node, (N,), numbers from 0 on; at most `count` of about the same size."""
    share = _node_areas(hull)
    most = min(count, int(np.count_nonzero(share)))
    seeds = np.random.default_rng(0).choice(len(share), most, replace=False, p=share / share.sum())
    return _settled(hull, seeds, STEPS)


def split_cells(hull: Hull, cell: IntArray, chosen: BoolArray) -> IntArray:
    """Return the cell of every node, (N,), where each of the `chosen` (C,) cells has become two."""
    middle = _means(cell, _node_areas(hull), hull.nodes)
    distance = np.linalg.norm(hull.nodes - middle[cell], axis=1)
    nearest, farthest = _first_nodes(cell, distance), _first_nodes(cell, -distance)
    return _settled(hull, np.union1d(nearest, farthest[chosen]), 1)


def cell_positions(hull: Hull, cell: IntArray) -> FloatArray:
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


def nearest_nodes(hull: Hull, cell: IntArray, positions: FloatArray) -> IntArray:
    """Return the node of each cell next to a position of each, (C,)."""
    return _first_nodes(cell, np.linalg.norm(hull.nodes - positions[cell], axis=1))


def _first_nodes(cell: IntArray, value: FloatArray) -> IntArray:
    """Return the node of the least value in each cell, (C,)."""
    order = np.lexsort((value, cell))
    return np.asarray(order[np.unique(cell[order], return_index=True)[1]])


def _settled(hull: Hull, seeds: IntArray, steps: int) -> IntArray:
    """Return the cells of seeds that have moved to the middle of their cells so many times."""
    edges, share = _edges(hull), _node_areas(hull)
    for _ in range(steps):
        cell = _next_seed(edges, seeds)
        seeds = nearest_nodes(hull, cell, _means(cell, share, hull.nodes))
    return np.unique(_next_seed(edges, seeds), return_inverse=True)[1]


def _edges(hull: Hull) -> csr_array:
    """Return the lengths of the edges between nodes, (N, N)."""
    starts, ends = hull.triangles.ravel(), np.roll(hull.triangles, -1, axis=1).ravel()
    pairs = np.unique(np.sort(np.stack([starts, ends], axis=1), axis=1), axis=0)
    length = np.linalg.norm(hull.nodes[pairs[:, 0]] - hull.nodes[pairs[:, 1]], axis=1)
    return coo_array((length, (pairs[:, 0], pairs[:, 1])), shape=(len(hull.nodes),) * 2).tocsr()


def _next_seed(edges: csr_array, seeds: IntArray) -> IntArray:
    """Return the number of the next seed of every node; parts of the surface without a seed are one cell."""
    _, _, source = dijkstra(edges, directed=False, indices=seeds, min_only=True, return_predecessors=True)
    number = np.full(edges.shape[0] + 1, len(seeds))
    number[seeds] = np.arange(len(seeds))
    return np.unique(number[source], return_inverse=True)[1]


def _node_areas(hull: Hull) -> FloatArray:
    """Return a third of the areas of the panels about each node, (N,), m^2."""
    shares = np.repeat(hull.areas / 3.0, 3)
    return np.asarray(np.bincount(hull.triangles.ravel(), shares, len(hull.nodes)), dtype=float)


def _means(cell: IntArray, weight: FloatArray, values: FloatArray) -> FloatArray:
    """Return the weighted means of values (N, 3) over each cell, (C, 3)."""
    whole = np.maximum(np.bincount(cell, weight), 1e-300)
    return np.stack([np.bincount(cell, weight * values[:, axis]) / whole for axis in range(3)], axis=1)
