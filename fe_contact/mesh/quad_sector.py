"""Transverse section of one tooth sector in eight-node quadrilaterals, nodes on the exact profile."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.quad_blocks import Block, fill_blocks
from fe_contact.mesh.quality import QualityLimits, refuse_poor_elements
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.sector_outline import SectorOutline, sector_outline
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.types import FloatArray

QUAD_LIMITS = QualityLimits(angle=np.radians(15.0), scaled_jacobian=0.1)


@dataclass(frozen=True)
class QuadSector:
    """One pitch of the gear in the tooth frame, from mid space to mid space, bore to tip."""

    points: FloatArray
    """Nodes, m. Shape (n, 2)."""
    grid: SectorGrid
    """Elements and where nodes lie. The left cut turned clockwise by one pitch is the right one."""
    s: FloatArray
    """Flank coordinates of `grid.flank`, m: corner, mid-side (at the exact middle), corner ... Shape (k,)."""
    normals: FloatArray
    """Outward unit normals of the exact profile there. Shape (k, 2)."""


def quad_sector(gear: Toothing, recipe: SectorRecipe, limits: QualityLimits = QUAD_LIMITS) -> QuadSector:
    """Mesh the transverse section of one tooth sector.

    `gear`: its modification, face width and hand play no part. Raises `MeshError`: gmsh failed, was killed or
    ran out of time, or an element misses its quality limit.
    """
    outline = sector_outline(tooth_profile(gear), recipe)
    grid = outline.grid
    points = _sector_points(outline, grid)
    refuse_poor_elements("sector section", points, grid.quads, limits)
    return QuadSector(points, grid, outline.s, outline.profile.normal(outline.s))


def _sector_points(outline: SectorOutline, grid: SectorGrid) -> FloatArray:
    """Place all nodes: corners by gmsh, middles of inner sides between them, the rest on exact curves."""
    tooth, *body = fill_blocks(_blocks(outline), outline.profile.gear.normal_module)
    points, number = np.empty((grid.nodes, 2)), grid.number
    low = 2 * grid.body_rows  # row of nodes at the split point; corners of elements are every other node
    # The blocks run from the bore up and from the right cut to the left one, as the grid does.
    points[number[: low + 1 : 2, ::2]] = np.concatenate([*(part[:-1] for part in body), body[-1][-1:]])
    stem = number[low:, 2 * grid.land : 2 * (grid.land + grid.across) + 1]
    points[stem[::2, ::2]] = tooth
    ends = np.stack([grid.quads[:, :4], np.roll(grid.quads[:, :4], -1, axis=1)])
    points[grid.quads[:, 4:]] = points[ends].mean(axis=0)
    points[stem[-1]] = outline.tip
    points[number[low, : 2 * grid.land + 1]] = outline.right_land
    points[number[low, -2 * grid.land - 1 :]] = (outline.right_land * [-1.0, 1.0])[::-1]
    points[grid.bore] = outline.bore
    for row, circle in outline.circles.items():
        points[number[low + 2 * row]] = circle
    points[stem[:, 0]] = outline.right_flank
    points[stem[:, -1]] = outline.right_flank * [-1.0, 1.0]
    return points


def _blocks(outline: SectorOutline) -> list[Block]:
    """Return the tooth, and the body from the bore up, by corner points.

    The body of a gear with a web is parted at its circles.
    """
    mirror = np.array([-1.0, 1.0])
    flank, cut = outline.right_flank[::2], outline.right_cut[::-2]
    rows = len(cut) - 1
    # upper edges of the parts by their row from the bore; circles count down from the split point
    levels = {0: outline.bore} | {rows + row: circle for row, circle in sorted(outline.circles.items())}
    levels[rows] = outline.body_top
    blocks = [Block(outline.base[::2], flank * mirror, outline.tip[::2], flank)]
    for (low, bottom), (high, top) in pairwise(levels.items()):
        side = cut[low : high + 1]
        blocks.append(Block(bottom[::2], side * mirror, top[::2], side))
    return blocks
