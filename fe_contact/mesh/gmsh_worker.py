"""Child process that meshes polygons with gmsh, and does nothing else.

Run as a script by `fe_contact.mesh.triangulation`, never imported by it: gmsh changes signal handlers, may
crash on hard input and keeps global state, so it lives and dies here. It reads one JSON object from
standard input and writes one to standard output::

    {"regions": [[loop, ...], ...], "growth": [0.3, ...], "seconds": 60}    loop = [[x, y], ...]
    {"regions": [{"points": [[x, y], ...], "triangles": [[i, j, k], ...]}, ...]}   or   {"error": "..."}

The first loop of a region is its outer boundary, further ones are holes. The loops' points come first in
``points``, in their order; no edge of a loop is divided. Or it fills four-sided blocks with quadrilaterals::

    {"blocks": [[bottom, right, top, left], ...], "seconds": 60}    side = [[x, y], ...], counter-clockwise
    {"blocks": [[row, ...], ...]}                                   row = [[x, y], ...], from left to right

Opposite sides have as many points; rows run from the bottom to the top, both included.
Keep the imports few: they are most of the run time.
"""

from __future__ import annotations

import json
import math
import os
import sys
from importlib import import_module
from types import ModuleType

from host.signals import end_after, handlers_restored

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

RESET_BY_GMSH = ("SIGTERM", "SIGHUP", "SIGPIPE", "SIGINT")

# numbers of gmsh: of a meshing algorithm, and of types of elements
FRONTAL_DELAUNAY = 6
TRIANGLE, QUADRILATERAL = 2, 3


class _LibrarySearch(ModuleType):
    """The module `ctypes.util`, imported if gmsh looks for its library where the system has them.

    Its imports take 10 ms, and the wheel has the library beside it.
    """

    def find_library(self, name: str) -> str | None:
        """Return the file of a library, None if the system has none of that name."""
        sys.modules.pop(self.__name__, None)
        return import_module(self.__name__).find_library(name)  # type: ignore[no-any-return]


def _start_gmsh() -> Any:
    """Import and start gmsh: one thread, silent, no user files, signal handlers left as they were."""
    sys.modules["numpy"] = None  # type: ignore[assignment] # gmsh's documented fallback; saves 0.2 CPU s of start-up
    sys.modules["ctypes.util"] = _LibrarySearch("ctypes.util")
    import gmsh  # noqa: PLC0415

    with handlers_restored(RESET_BY_GMSH):
        gmsh.initialize(["loa", "-nopopup"], readConfigFiles=False, interruptible=False)
    options = {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Mesh.Algorithm": FRONTAL_DELAUNAY,
        "Mesh.MeshSizeExtendFromBoundary": 0,
        "Mesh.MeshSizeFromPoints": 0,
        "Mesh.Optimize": 1,
    }
    for name, value in options.items():
        gmsh.option.setNumber(name, value)
    return gmsh


def _add_loop(gmsh: Any, loop: list[list[float]]) -> tuple[list[int], int]:
    """Add a closed polygon whose edges stay undivided; return its point tags and its curve loop."""
    geo = gmsh.model.geo
    points = [geo.addPoint(x, y, 0.0) for x, y in loop]
    lines = [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    return points, geo.addCurveLoop(lines)


def _grow_from(gmsh: Any, loops: list[list[list[float]]], tags: list[int], growth: float) -> None:
    """Let the size grow with the distance from the boundary, where it is the length of the edges.

    Points of like size (within a factor of sqrt 2) share one distance field, so that few fields are needed.
    """
    edges = [math.dist(a, b) for loop in loops for a, b in zip(loop, loop[1:] + loop[:1], strict=True)]
    classes: dict[int, list[tuple[float, int]]] = {}
    for edge, tag in zip(edges, tags, strict=True):
        classes.setdefault(round(2.0 * math.log2(edge)), []).append((edge, tag))
    field, sizes = gmsh.model.mesh.field, []
    for members in classes.values():
        distance, size = field.add("Distance"), field.add("MathEval")
        field.setNumbers(distance, "PointsList", [tag for _, tag in members])
        mean = sum(edge for edge, _ in members) / len(members)
        field.setString(size, "F", f"{mean!r} + {growth!r} * F{distance}")
        sizes.append(size)
    minimum = field.add("Min")
    field.setNumbers(minimum, "FieldsList", sizes)
    field.setAsBackgroundMesh(minimum)


def _triangulate(
    gmsh: Any, loops: list[list[list[float]]], growth: float
) -> dict[str, list[list[float]] | list[list[int]]]:
    """Return the points and triangles of one region; points of the loops come first."""
    gmsh.clear()
    gmsh.model.add("region")
    added = [_add_loop(gmsh, loop) for loop in loops]
    surface = gmsh.model.geo.addPlaneSurface([loop for _, loop in added])
    gmsh.model.geo.synchronize()
    boundary = [point for points, _ in added for point in points]
    _grow_from(gmsh, loops, boundary, growth)
    gmsh.model.mesh.generate(2)
    number = {int(gmsh.model.mesh.getNodes(0, tag)[0][0]): i for i, tag in enumerate(boundary)}
    points: list[list[float]] = [xy for loop in loops for xy in loop]
    tags, flat, _ = gmsh.model.mesh.getNodes(2, surface)
    for i, tag in enumerate(tags):
        number[int(tag)] = len(points)
        points.append([flat[3 * i], flat[3 * i + 1]])
    corners = [number[int(tag)] for tag in gmsh.model.mesh.getElementsByType(TRIANGLE, surface)[1]]
    return {"points": points, "triangles": [corners[i : i + 3] for i in range(0, len(corners), 3)]}


def _fill_block(gmsh: Any, sides: list[list[list[float]]]) -> list[list[list[float]]]:
    """Fill a four-sided block by transfinite interpolation; return its rows of points."""
    gmsh.clear()
    gmsh.model.add("block")
    tags, loop = _add_loop(gmsh, [xy for side in sides for xy in side[:-1]])
    geo, corners = gmsh.model.geo, [0]
    surface = geo.addPlaneSurface([loop])
    for side in sides:
        corners.append(corners[-1] + len(side) - 1)
    geo.mesh.setTransfiniteSurface(surface, cornerTags=[tags[i] for i in corners[:4]])
    geo.mesh.setRecombine(2, surface)
    geo.synchronize()
    gmsh.model.mesh.generate(2)
    flat = [int(tag) for tag in gmsh.model.mesh.getElementsByType(QUADRILATERAL)[1]]
    bottom = [int(gmsh.model.mesh.getNodes(0, tag)[0][0]) for tag in tags[: len(sides[0])]]
    rows = _rows_above(bottom, [flat[i : i + 4] for i in range(0, len(flat), 4)])
    numbers, xyz, _ = gmsh.model.mesh.getNodes()
    points = {int(tag): [xyz[3 * i], xyz[3 * i + 1]] for i, tag in enumerate(numbers)}
    return [[points[tag] for tag in row] for row in rows]


def _rows_above(bottom: list[int], quads: list[list[int]]) -> list[list[int]]:
    """Order the nodes of a structured mesh in rows from the bottom up, by the sides that elements share."""
    neighbors: dict[frozenset[int], list[int]] = {}
    for number, quad in enumerate(quads):
        for a, b in zip(quad, quad[1:] + quad[:1], strict=True):
            neighbors.setdefault(frozenset((a, b)), []).append(number)
    rows: list[list[int]] = [bottom]
    used: set[int] = set()
    while len(used) < len(quads):
        row: list[int] = []
        for a, b in zip(rows[-1], rows[-1][1:], strict=False):
            (number,) = set(neighbors[frozenset((a, b))]) - used
            used.add(number)
            if not row:
                row.append(_neighbor(quads[number], a, b))
            row.append(_neighbor(quads[number], b, a))
        rows.append(row)
    return rows


def _neighbor(quad: list[int], node: int, other: int) -> int:
    """Return the neighbor of a corner that is not `other`."""
    i = quad.index(node)
    return quad[i - 1] if quad[i - 1] != other else quad[(i + 1) % 4]


def main() -> None:
    """Answer the one request on standard input."""
    answer_to = os.dup(1)
    os.dup2(2, 1)  # whatever gmsh prints must not mix with the answer
    request = json.load(sys.stdin)
    end_after(int(request["seconds"]) + 1)  # ends this process even when its parent is gone
    try:
        gmsh = _start_gmsh()
        answer: dict[str, Any] = {
            "regions": [
                _triangulate(gmsh, loops, growth)
                for loops, growth in zip(request.get("regions", []), request.get("growth", []), strict=True)
            ],
            "blocks": [_fill_block(gmsh, sides) for sides in request.get("blocks", [])],
        }
    except Exception as error:  # noqa: BLE001 - gmsh raises bare Exception; the parent turns the text into a MeshError
        answer = {"error": str(error) or type(error).__name__}
    with os.fdopen(answer_to, "w") as stream:
        json.dump(answer, stream)


if __name__ == "__main__":
    main()
