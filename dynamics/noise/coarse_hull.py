"""A hull with fewer panels, for models whose cost grows with the square of their number.

The surface of the fine hull is divided into cells, each of the nodes that are nearest to a seed along the
surface. A cell becomes one node of the coarse hull, where the planes of the cell's panels meet best.

Shapes: N nodes and T panels of a hull, C cells, r reduced coordinates of the housing's motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import Hull, OuterHull
from dynamics.acoustics.hull import PANELS_PER_WAVELENGTH, ROUNDED_DOWN, flat_triangles
from dynamics.identity_cache import identity_cached
from dynamics.types import BoolArray, FloatArray, IntArray
from host.optional_modules import csgraph, sparse

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
"""Most rounds of exchanges of diagonals; a row of nodes on a straight edge needs several."""
LONGEST = 2.0
"""Longest edge of a coarse hull over its mean distance of nodes, as expected."""
ATTEMPTS = 16
"""Most attempts to split cells; walls of gear cases took up to six."""
FEWER = 0.5
"""Most nodes of a coarse hull over those of the fine one; with more of them the fine hull is taken."""


def surface_cells(hull: Hull, count: int) -> IntArray:
    """Return the number of the cell of every node, (N,); at most `count` cells of about the same size."""
    share = _node_areas(hull)
    maximum = min(count, int(np.count_nonzero(share)))
    seeds = np.random.default_rng(0).choice(len(share), maximum, replace=False, p=share / share.sum())
    return settled_cells(hull, seeds, STEPS)


def split_cells(hull: Hull, cell: IntArray, chosen: BoolArray) -> IntArray:
    """Return the cell of every node, (N,), after each of the `chosen` (C,) cells was divided in two.

    The seeds of the two are the nodes of the cell nearest to its middle and farthest from it.
    """
    middle = _means(cell, _node_areas(hull), hull.nodes)
    distance = np.linalg.norm(hull.nodes - middle[cell], axis=1)
    nearest, farthest = _first_nodes(cell, distance), _first_nodes(cell, -distance)
    return settled_cells(hull, np.union1d(nearest, farthest[chosen]), 1)


def _cell_positions(hull: Hull, cell: IntArray) -> FloatArray:
    """Return a node for each cell, (C, 3) in m, next to the planes of all its panels.

    Edges and corners so stay sharp. The node minimizes the sum of the squared distances from the planes,
    weighted by the areas of the panels; a panel counts for the cell of each of its corners.
    """
    count, owner = int(cell.max()) + 1, cell[hull.triangles].ravel()
    planes, offset = np.zeros((count, 3, 3)), np.zeros((count, 3))
    weighted = np.repeat(hull.area_vectors, 3, axis=0)
    normals = np.repeat(hull.normals, 3, axis=0)
    np.add.at(planes, owner, weighted[:, :, None] * normals[:, None])
    middle = _means(cell, _node_areas(hull), hull.nodes)
    height = np.sum(normals * (np.repeat(hull.centers, 3, axis=0) - middle[owner]), axis=1)
    np.add.at(offset, owner, weighted * height[:, None])
    # in directions in which a flat cell has no planes, the pseudoinverse leaves the node in the middle
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
    order = np.lexsort((value, cell))  # by cell, then by value
    _, first = np.unique(cell[order], return_index=True)
    return np.asarray(order[first])


def settled_cells(hull: Hull, seeds: IntArray, steps: int) -> IntArray:
    """Return the cells of seeds, (N,), after the seeds moved to the middle of their cells so many times."""
    starts, ends = hull.triangles.ravel(), np.roll(hull.triangles, -1, axis=1).ravel()
    pairs = np.unique(np.sort(np.stack([starts, ends], axis=1), axis=1), axis=0)
    length = np.linalg.norm(hull.nodes[pairs[:, 0]] - hull.nodes[pairs[:, 1]], axis=1)
    edges = sparse.coo_array((length, (pairs[:, 0], pairs[:, 1])), shape=(len(hull.nodes),) * 2).tocsr()
    share = _node_areas(hull)
    for _ in range(steps):
        cell = _next_seed(edges, seeds)
        seeds = _nearest_nodes(hull, cell, _means(cell, share, hull.nodes))
    return np.unique(_next_seed(edges, seeds), return_inverse=True)[1]


def _next_seed(edges: sparse.csr_array, seeds: IntArray) -> IntArray:
    """Return the number of the nearest seed of every node; surfaces without a seed are one cell."""
    _, _, source = csgraph.dijkstra(
        edges, directed=False, indices=seeds, min_only=True, return_predecessors=True
    )
    number = np.full(edges.shape[0], len(seeds))
    number[seeds] = np.arange(len(seeds))
    reached = source >= 0  # scipy marks a node that is connected with no seed by a negative number
    cell = np.where(reached, number[np.where(reached, source, 0)], len(seeds))
    return np.unique(cell, return_inverse=True)[1]


def _node_areas(hull: Hull) -> FloatArray:
    """Return a third of the areas of the panels about each node, (N,), m^2."""
    shares = np.repeat(hull.areas / 3.0, 3)
    return np.asarray(np.bincount(hull.triangles.ravel(), shares, len(hull.nodes)), dtype=float)


def _means(cell: IntArray, weight: FloatArray, values: FloatArray) -> FloatArray:
    """Return the weighted means of values (N, 3) over each cell, (C, 3)."""
    total = np.maximum(np.bincount(cell, weight), 1e-300)  # a cell of nodes without panels has weight 0
    return np.stack([np.bincount(cell, weight * values[:, axis]) / total for axis in range(3)], axis=1)


def _without_thin(nodes: FloatArray, triangles: IntArray) -> IntArray:
    """Return the triangles (T, 3) after thin ones were divided otherwise.

    A thin triangle and its neighbor at its longest edge form a quadrilateral, which is divided along its
    other diagonal. A closed surface stays closed.
    """
    result = np.array(triangles)
    for _ in range(ROUNDS):
        turned, thin = _longest_first(nodes, result)
        if not np.any(thin):
            break
        _exchange(turned, result, np.flatnonzero(thin))
    return result


def _longest_first(nodes: FloatArray, triangles: IntArray) -> tuple[IntArray, BoolArray]:
    """Return the triangles, turned so that the longest edge comes first, and which of them are thin."""
    length = np.linalg.norm(nodes[np.roll(triangles, -1, axis=1)] - nodes[triangles], axis=2)
    first = np.argmax(length, axis=1)
    turned = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    a, b, c = np.moveaxis(nodes[turned], 1, 0)
    height = np.linalg.norm(np.cross(b - a, c - a), axis=1) / length.max(axis=1)
    return turned, height < THIN * length.max(axis=1)


def _exchange(turned: IntArray, result: IntArray, thin: IntArray) -> None:
    """Exchange the diagonals of thin triangles with their neighbors, each of which takes part once."""
    beyond = {  # by directed edge: the triangle that has it, and the corner opposite to it
        (int(nodes[k]), int(nodes[(k + 1) % 3])): (index, int(nodes[(k + 2) % 3]))
        for index, nodes in enumerate(result)
        for k in range(3)
    }
    done: set[int] = set()
    for index in thin.tolist():
        p, q, top = (int(node) for node in turned[index])
        other, far = beyond.get((q, p), (index, top))  # the neighbor; at an open edge the triangle itself
        if index in done or other in done or far == top or other == index:
            continue
        if (top, far) in beyond or (far, top) in beyond:
            continue  # the new diagonal is an edge already
        result[index], result[other] = (top, p, far), (top, far, q)
        beyond[top, far] = beyond[far, top] = (index, p)  # an edge from now on
        done |= {index, other}


@dataclass(frozen=True)
class Coarseness:
    """The coarseness of a hull."""

    edges: float = PANELS_PER_WAVELENGTH
    """Least number of longest edges in a wavelength."""
    cells: int = 800
    """Least number of cells, which the shape of a body needs at any frequency."""


OF_PANELS = Coarseness()
"""Coarseness for models by panels. With 800 cells a sphere loses 1 % of its volume, and the sound of its
motion as a dipole 0.1 dB.
"""


@dataclass(frozen=True)
class RadiatingHull:
    """Panels and their motion: `shapes` (T, r), mean outward displacement per reduced coordinate."""

    hull: Hull
    shapes: FloatArray


@identity_cached
def radiating_hull(
    outer: OuterHull, highest_frequency: float, sound_speed: float, coarseness: Coarseness = OF_PANELS
) -> RadiatingHull:
    """Return a coarse closed hull that resolves a frequency in Hz, or the fine hull.

    The fine hull is returned where a coarse one would need more than `FEWER` of its nodes. Cells are split
    where edges are too long, or where the coarse hull is open because it meets itself around a thin part.
    """
    fine, maximum = RadiatingHull(outer.hull, outer.shapes), FEWER * len(outer.hull.nodes)
    longest = sound_speed / highest_frequency / coarseness.edges * ROUNDED_DOWN
    cell_area = (
        0.5 * np.sqrt(3.0) * (longest / LONGEST) ** 2
    )  # nodes at this distance in a triangular lattice
    count = max(int(np.ceil(outer.hull.area / cell_area)), coarseness.cells)
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
    """Return a hull with one node for each cell, and the cell of each of its nodes.

    Cells lie along the surface, so that both sides of a thin wall stay apart. Where three cells meet there is
    a panel; a cell that meets fewer than two others has no node. A panel moves as the fine surface next to
    its corners. A uniform velocity is added so that each coordinate displaces the same volume as on the fine
    hull: sound of long waves depends on that volume.
    """
    hull = outer.hull
    triangles = cell[hull.triangles]
    has_area = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
    used, corners = np.unique(triangles[has_area], return_inverse=True)
    nodes = _cell_positions(hull, cell)
    fine_node = _nearest_nodes(hull, cell, nodes)[used]
    corners = _without_thin(nodes[used], corners.reshape(-1, 3))
    coarse = Hull(nodes[used], corners[~flat_triangles(nodes[used], corners)])
    shapes = OuterHull(coarse, outer.motion[fine_node], inner_area=0.0, cap_area=0.0).shapes
    lost_flow = hull.areas @ outer.shapes - coarse.areas @ shapes
    return RadiatingHull(coarse, shapes + lost_flow / coarse.area), used
