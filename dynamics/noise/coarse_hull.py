"""A hull with fewer panels, for models whose cost grows with the square of their number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import Hull, OuterHull
from dynamics.acoustics.hull import PANELS_PER_WAVELENGTH, ROUNDED_DOWN, flat_triangles
from dynamics.identity_cache import identity_cached
from dynamics.noise.surface_cells import cell_positions, nearest_nodes, split_cells, surface_cells
from dynamics.noise.thin_panels import without_thin
from dynamics.types import FloatArray, IntArray

LONGEST = 2.0
"""Longest edge of a coarse hull over its mean distance of nodes."""
ATTEMPTS = 16
"""To split cells; walls of gear cases took up to six."""
FEWER = 0.5
"""Nodes of a coarse hull over those of the fine one, at most: otherwise the fine one is taken."""
FEWEST = 800
"""Cells for the shape of a body: a sphere loses 1 % of its volume, 0.1 dB of what it radiates as a dipole."""


@dataclass(frozen=True)
class RadiatingHull:
    """Panels and their motion: `shapes` (T, r), mean outward displacement per reduced coordinate."""

    hull: Hull
    shapes: FloatArray


@identity_cached
def radiating_hull(outer: OuterHull, highest_frequency: float, sound_speed: float) -> RadiatingHull:
    """Return a coarse closed hull that resolves a frequency in Hz; the fine one if that is hardly finer.

    Cells are split where edges come out too long, or where the hull meets itself around a thin part.
    """
    fine, most = RadiatingHull(outer.hull, outer.shapes), FEWER * len(outer.hull.nodes)
    longest = sound_speed / highest_frequency / PANELS_PER_WAVELENGTH * ROUNDED_DOWN
    count = max(int(np.ceil(outer.hull.area / (0.5 * np.sqrt(3.0) * (longest / LONGEST) ** 2))), FEWEST)
    if count >= most:
        return fine
    cell = surface_cells(outer.hull, count)
    for _ in range(ATTEMPTS):
        coarse, owner = coarse_hull(outer, cell)
        poor = np.concatenate([coarse.hull.open_edges, coarse.hull.longer_edges(longest)])
        if not poor.size:
            return coarse
        cell = split_cells(outer.hull, cell, np.isin(np.arange(cell.max() + 1), owner[poor]))
        if cell.max() >= most:
            break
    return fine


def coarse_hull(outer: OuterHull, cell: IntArray) -> tuple[RadiatingHull, IntArray]:
    """Return a hull that has a node for each cell of the nodes, and the cell of each of its nodes.

    A cell, which lies along the surface so that thin walls stay apart, becomes the node nearest to the
    planes of its panels: edges stay sharp. Where three cells meet there is a panel. It moves as the surface
    does next to its corners; a uniform velocity restores the volume that each coordinate displaces, on which
    sound of long waves depends. Cells that meet fewer than two others have no node.
    """
    hull = outer.hull
    triangles = cell[hull.triangles]
    apart = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
    used, corners = np.unique(triangles[apart], return_inverse=True)
    nodes = cell_positions(hull, cell)
    near = nearest_nodes(hull, cell, nodes)[used]
    corners = without_thin(nodes[used], corners.reshape(-1, 3))
    coarse = Hull(nodes[used], corners[~flat_triangles(nodes[used], corners)])
    shapes = OuterHull(coarse, outer.motion[near], 0.0, 0.0).shapes
    lost = hull.areas @ outer.shapes - coarse.areas @ shapes
    return RadiatingHull(coarse, shapes + lost / coarse.area), used
