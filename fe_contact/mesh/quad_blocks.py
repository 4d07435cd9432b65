"""Four-sided blocks filled with rows of quadrilaterals by gmsh's transfinite interpolation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.mesh.gmsh_process import ask_gmsh
from fe_contact.types import FloatArray


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
    """Fill each block with quadrilaterals, all in one child process: the gmsh worker, or `command`.

    The unit of length of gmsh is `scale`, m, since its tolerances are absolute; the time limit is `seconds`.
    Corner points (rows, columns, 2) are from the bottom up and from left to right; those on the sides are the
    given ones, bit for bit. Raises `MeshError`: the child failed, was killed, ran out of time or answered
    nonsense; the message says which.
    """
    answer = ask_gmsh({"blocks": [block.loop(scale) for block in blocks]}, seconds, command)
    try:
        grids = [np.array(rows, dtype=float) * scale for rows in answer["blocks"]]
        return [_received(block, points) for block, points in zip(blocks, grids, strict=True)]
    except (KeyError, ValueError, TypeError) as error:
        raise MeshError("gmsh worker: unusable answer") from error


def _received(block: Block, points: FloatArray) -> FloatArray:
    if points.shape != (len(block.left), len(block.bottom), 2):
        raise ValueError(f"block of shape {points.shape}")
    points[0], points[-1], points[:, 0], points[:, -1] = block.bottom, block.top, block.left, block.right
    return points
