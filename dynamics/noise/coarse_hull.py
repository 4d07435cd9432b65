"""A hull with fewer panels, for models whose cost grows with the square of their number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import Hull, OuterHull
from dynamics.acoustics.hull import PANELS_PER_WAVELENGTH, flat_triangles
from dynamics.identity_cache import identity_cached
from dynamics.noise.surface_cells import cell_positions, nearest_nodes, surface_cells
from dynamics.noise.thin_panels import without_thin
from dynamics.types import FloatArray

LONGEST = 2.0
"""Longest edge of a coarse hull over its mean distance of nodes."""
FEWEST = 800
"""Cells for the shape of a body: a sphere loses 1 % of its volume, 0.1 dB of what it radiates as a dipole."""
FINER = 1.2
"""Cells of the next attempt, where edges are too long or cells meet themselves around a thin part."""


@dataclass(frozen=True)
class RadiatingHull:
    """Panels and their motion: `shapes` (T, r), mean outward displacement per reduced coordinate."""

    hull: Hull
    shapes: FloatArray


@identity_cached
def radiating_hull(outer: OuterHull, highest_frequency: float, sound_speed: float) -> RadiatingHull:
    """Return a coarse closed hull that resolves a frequency in Hz; the fine one if that is hardly finer."""
    edge = sound_speed / highest_frequency / PANELS_PER_WAVELENGTH / LONGEST
    cells = max(int(np.ceil(outer.hull.area / (0.5 * np.sqrt(3.0) * edge**2))), FEWEST)
    while 2 * cells < len(outer.hull.nodes):
        coarse = coarse_hull(outer, cells)
        resolved = coarse.hull.highest_wavenumber >= 2.0 * np.pi * highest_frequency / sound_speed
        if resolved and coarse.hull.closed:
            return coarse
        cells = int(FINER * cells)
    return RadiatingHull(outer.hull, outer.shapes)


def coarse_hull(outer: OuterHull, cells: int) -> RadiatingHull:
    """Return a hull of about `cells` nodes.

    The surface falls into cells of the nodes next to seeds, along the surface, so that thin walls stay apart.
    A cell becomes the node nearest to the planes of its panels: edges stay sharp. Where three cells meet
    there is a panel. It moves as the surface does next to its corners; a uniform velocity restores the
    volume that each coordinate displaces, on which sound of long waves depends.
    """
    hull = outer.hull
    cell = surface_cells(hull, cells)
    triangles = cell[hull.triangles]
    apart = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
    used, corners = np.unique(triangles[apart], return_inverse=True)
    nodes = cell_positions(hull, cell)
    near = nearest_nodes(hull, cell, nodes)[used]
    corners = without_thin(nodes[used], corners.reshape(-1, 3))
    coarse = Hull(nodes[used], corners[~flat_triangles(nodes[used], corners)])
    shapes = OuterHull(coarse, outer.motion[near], 0.0, 0.0).shapes
    lost = hull.areas @ outer.shapes - coarse.areas @ shapes
    return RadiatingHull(coarse, shapes + lost / coarse.area)
