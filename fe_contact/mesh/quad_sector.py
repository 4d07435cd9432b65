"""Transverse section of one tooth sector in eight-node quadrilaterals, nodes on the exact profile."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.gmsh_child import ask_gmsh
from fe_contact.mesh.quad_quality import refuse_poor_quads
from fe_contact.mesh.quality import QualityLimits
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.sector_outline import SectorOutline, sector_outline
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.types import FloatArray

# Four-sided blocks filled with rows of quadrilaterals by gmsh's transfinite interpolation.


@dataclass(frozen=True)
class Block:
    """Sides of a block, each (n, 2) in m, divided alike on opposite sides.

    `bottom` and `top` run from left to right, `left` and `right` from bottom to top; ends are shared.
    """

    bottom: FloatArray
    right: FloatArray
    top: FloatArray
    left: FloatArray

    def loop(self, scale: float) -> list[list[list[float]]]:
        """Return the four sides counter-clockwise, in multiples of `scale`."""
        sides = (self.bottom, self.right, self.top[::-1], self.left[::-1])
        return [(side / scale).tolist() for side in sides]


def fill_blocks(
    blocks: Sequence[Block], scale: float, seconds: float = 60.0, command: Sequence[str] | None = None
) -> list[FloatArray]:
    """Fill each block with quadrilaterals.

    Parameters
    ----------
    blocks : sequence of Block
        Meshed one by one in the same child process.
    scale : float
        Length of the size of the blocks, m: gmsh works in multiples of it (its tolerances are absolute).
    seconds : float
        Time limit of the child.
    command : sequence of str, optional
        Program to run in place of the gmsh worker.

    Returns
    -------
    list of (rows, columns, 2) arrays
        Corner points of the quadrilaterals, m, from the bottom up and from left to right. Points on the
        sides are the given ones, bit for bit.

    Raises
    ------
    MeshError
        The child failed, was killed, ran out of time or answered nonsense; the message says which.
    """
    answer = ask_gmsh({"blocks": [block.loop(scale) for block in blocks]}, seconds, command)
    try:
        grids = [np.array(rows, dtype=float) * scale for rows in answer["blocks"]]
        return [_received(block, points) for block, points in zip(blocks, grids, strict=True)]
    except (KeyError, ValueError, TypeError) as error:
        raise MeshError("gmsh worker: unusable answer") from error


def _received(block: Block, points: FloatArray) -> FloatArray:
    """Return one answer with the points of the sides as they were given."""
    if points.shape != (len(block.left), len(block.bottom), 2):
        raise ValueError(f"block of shape {points.shape}")
    points[0], points[-1], points[:, 0], points[:, -1] = block.bottom, block.top, block.left, block.right
    return points


QUAD_LIMITS = QualityLimits(angle=np.radians(15.0), scaled_jacobian=0.1)


@dataclass(frozen=True)
class QuadSector:
    """One pitch of the gear in the tooth frame, from mid space to mid space, bore to tip.

    Attributes
    ----------
    points : (n, 2) array
        Nodes, m.
    grid : SectorGrid
        Elements and where nodes lie. The left cut turned clockwise by one pitch is the right one.
    s : (k,) array
        Flank coordinates of `grid.flank`, m: corner, mid-side (at the exact middle), corner ...
    normals : (k, 2) array
        Outward unit normals of the exact profile there.
    """

    points: FloatArray
    grid: SectorGrid
    s: FloatArray
    normals: FloatArray


def quad_sector(
    gear: Toothing, recipe: SectorRecipe, limits: QualityLimits = QUAD_LIMITS, seconds: float = 60.0
) -> QuadSector:
    """Mesh the transverse section of one tooth sector.

    Parameters
    ----------
    gear : Gear or RingGear
        Its modification, face width and hand play no part.
    recipe : SectorRecipe
        Element sizes.
    limits : QualityLimits
        Least acceptable element quality.
    seconds : float
        Time limit of gmsh, which runs in a child process.

    Raises
    ------
    MeshError
        gmsh failed, was killed or ran out of time, or an element misses its quality limit.
    """
    outline = sector_outline(tooth_profile(gear), recipe)
    grid = outline.grid
    points = _sector_points(outline, grid, seconds)
    refuse_poor_quads(points, grid.quads, limits)
    return QuadSector(points, grid, outline.s, outline.profile.normal(outline.s))


def _sector_points(outline: SectorOutline, grid: SectorGrid, seconds: float) -> FloatArray:
    """Place all nodes: corners by gmsh, middles of inner sides between them, the rest on exact curves."""
    tooth, *body = fill_blocks(_blocks(outline), outline.profile.gear.normal_module, seconds)
    points, number, low = np.empty((grid.nodes, 2)), grid.number, 2 * grid.body_rows
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

    Their left is the loaded side, as in the grid. The body of a gear with a web is parted at its circles.
    """
    mirror = np.array([-1.0, 1.0])
    flank, cut = outline.right_flank[::2], outline.right_cut[::-2]
    rows = len(cut) - 1
    levels = {0: outline.bore} | {rows + row: c for row, c in sorted(outline.circles.items())}
    levels[rows] = outline.body_top
    blocks = [Block(outline.base[::2], flank * mirror, outline.tip[::2], flank)]
    for (low, bottom), (high, top) in pairwise(levels.items()):
        side = cut[low : high + 1]
        blocks.append(Block(bottom[::2], side * mirror, top[::2], side))
    return blocks
