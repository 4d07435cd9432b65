"""Triangulation of polygonal regions by gmsh in a child process of its own."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.types import FloatArray, IntArray, Json
from host import ChildFailed, ChildOutOfMemory, ask_child

# The child process that gmsh lives in: one request, one answer, its failures as `MeshError`.


WORKER = Path(__file__).with_name("gmsh_worker.py")


def ask_gmsh(request: Json, seconds: float, command: Sequence[str] | None = None) -> Json:
    """Run the child on one request and return its answer.

    Parameters
    ----------
    request : dict
        Plain JSON, see `gmsh_worker`.
    seconds : float
        Time limit; the child is killed after it.
    command : sequence of str, optional
        Program to run in place of the gmsh worker.

    Raises
    ------
    MeshError
        The child failed, was killed, ran out of time or answered nonsense; the message says which.
    """
    try:
        return ask_child(request, seconds, command or (sys.executable, "-P", str(WORKER)))
    except ChildOutOfMemory as error:
        advice = "Select a coarser level, or raise the memory limit."
        raise MeshError(f"gmsh worker: {error}. {advice}") from error
    except ChildFailed as error:
        raise MeshError(f"gmsh worker: {error}") from error


@dataclass(frozen=True)
class Region:
    """Polygon with holes: `loops[0]` is the outer boundary, each loop (n, 2), first point not repeated."""

    loops: tuple[FloatArray, ...]


@dataclass(frozen=True)
class Triangulation:
    """Straight triangles.

    Attributes
    ----------
    points : (n, 2) array
        The points of the region's loops first, bit for bit and in their order, then the inner ones.
    triangles : (m, 3) array
        Corner indices, counter-clockwise.
    """

    points: FloatArray
    triangles: IntArray


def triangulate(
    regions: Sequence[Region],
    scale: float,
    growth: float = 0.3,
    seconds: float = 60.0,
    command: Sequence[str] | None = None,
) -> list[Triangulation]:
    """Fill each region with triangles that keep the edges of its loops undivided.

    The size of the triangles grows from that of the boundary edges.

    Parameters
    ----------
    regions : sequence of Region
        Meshed one by one in the same child process.
    scale : float
        Length of the size of the regions, m: gmsh works in multiples of it (its tolerances are absolute).
    growth : float
        Growth of the element size per unit distance from the boundary.
    seconds : float
        Time limit; the child is killed after it.
    command : sequence of str, optional
        Program to run in place of the gmsh worker.

    Raises
    ------
    MeshError
        The child failed, was killed, ran out of time or answered nonsense; the message says which.
    """
    loops = [[(loop / scale).tolist() for loop in r.loops] for r in regions]
    answer = ask_gmsh({"regions": loops, "growth": growth}, seconds, command)
    try:
        return [_received(r, mesh, scale) for r, mesh in zip(regions, answer["regions"], strict=True)]
    except (KeyError, ValueError, TypeError) as error:
        raise MeshError("gmsh worker: unusable answer") from error


def _received(region: Region, mesh: dict[str, Any], scale: float) -> Triangulation:
    """Convert one answer, with the boundary points as they were given and triangles counter-clockwise."""
    points = np.array(mesh["points"], dtype=float).reshape(-1, 2) * scale
    boundary = np.concatenate(region.loops)
    points[: len(boundary)] = boundary
    triangles = np.array(mesh["triangles"], dtype=np.int64).reshape(-1, 3)
    if len(triangles) == 0:
        raise ValueError("no triangles")
    a, b, c = (points[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    clockwise = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
    triangles[clockwise] = triangles[clockwise][:, [0, 2, 1]]
    return Triangulation(points, triangles)
