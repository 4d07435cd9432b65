"""Child process that meshes a STEP file with gmsh, measures its faces or draws them, and does nothing else.

Run as a script by `dynamics.housings.step_files`: gmsh changes signal handlers, may crash on hard input and
keeps global state, so it lives and dies here, in a folder of its own, which is all that it can reach
(`host.confine`). A process that is confined already and answers once calls `step_answer` itself. The script
reads one JSON object from standard input and writes one to standard output::

    {"step": "housing.step", "mesh": "housing.msh", "size": m or null, "wall_elements": 0.7, "seconds": 600}
    {"solids": 1, "size": 0.014}   or   {"error": "..."}

With no mesh to write the answer has the volume and the surface of the solid, its flat faces as ``planes``
(point, outward normal, area) and its hollow faces of cylinders as ``walls`` (a point on the axis, the axis,
radius, area, both ends along the axis from the point); m. With ``triangles`` to draw at most, it has the
``points`` (m) and ``facets`` of about as many coarse ones, all corners on the surface.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from host import Limits, confine, end_after, handlers_restored

RESET_BY_GMSH = ("SIGTERM", "SIGHUP", "SIGPIPE", "SIGINT")
MILLIMETER = 1e-3  # meters per unit of gmsh's models
ELEMENTS_A_TURN = 12  # elements around a full turn of curvature
DRAWN_A_TURN, DRAWN_ELEMENTS, DRAWN_SMALLEST = 16, 40, 400
"""Elements of a drawn surface around a full turn of curvature; least number of elements across the body where
it is flat; largest number across the body where it is curved.
"""
EDGE_POINTS = 17
"""Points along an edge of a hollow face, of which the ends of the face are found."""
FRONTAL_DELAUNAY = 6  # number of the algorithm in gmsh
WORST = 0.05
"""Quality of a tetrahedron (its inverse condition number, 1 if it is regular) below which a mesh is made
again: Delaunay's method leaves slivers in the walls of castings."""


def limits(seconds: float) -> Limits:
    """Return the limits of a process that meshes within `seconds`; memory as for the parent process."""
    return Limits(memory_mb=None, cpu_seconds=int(seconds) + 1)


def _start_gmsh() -> Any:
    """Import and start gmsh: one thread, silent, no user files, signal handlers left as they were."""
    import gmsh  # noqa: PLC0415

    with handlers_restored(RESET_BY_GMSH):
        gmsh.initialize(["loa", "-nopopup"], readConfigFiles=False, interruptible=False)
    options = {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Geometry.OCCImportLabels": 0,  # with labels, other files that a STEP file names are read
        "Mesh.Algorithm": FRONTAL_DELAUNAY,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 1,
        "Mesh.MeshSizeFromPoints": 0,
        "Mesh.MeshSizeFromCurvature": ELEMENTS_A_TURN,
        "Mesh.Optimize": 1,
    }
    for name, value in options.items():
        gmsh.option.setNumber(name, value)
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    return gmsh


def step_answer(request: dict[str, Any]) -> dict[str, Any]:
    """Mesh, measure or draw the one solid of a file; raises MemoryError, or the bare Exception of gmsh."""
    gmsh = _start_gmsh()
    gmsh.clear()  # the model of an earlier file in the same process
    try:
        gmsh.model.occ.importShapes(request["step"])
        gmsh.model.occ.synchronize()
    except Exception:  # noqa: BLE001 - its text may hold what is in the file
        return {"error": "gmsh does not read the file"}
    solids = gmsh.model.getEntities(3)
    if len(solids) != 1:
        return {"solids": len(solids)}
    kind = _drawn if request.get("triangles") else _meshed if request["mesh"] else _measured
    return kind(gmsh, solids[0][1], request)


def _meshed(gmsh: Any, solid: int, request: dict[str, Any]) -> dict[str, Any]:
    """Write the mesh of a solid, in mm; return the largest element size, m."""
    size = request["size"] or MILLIMETER * _wall_thickness(gmsh, solid) / request["wall_elements"]
    gmsh.option.setNumber("Mesh.MeshSizeMax", size / MILLIMETER)
    gmsh.model.addPhysicalGroup(3, [solid])  # only its elements are written
    try:
        gmsh.model.mesh.generate(3)
        _, tags, _ = gmsh.model.mesh.getElements(3)
        if min(quality.min() for quality in map(gmsh.model.mesh.getElementQualities, tags)) < WORST:
            # twice the time, a sixth more elements: on demand
            gmsh.option.setNumber("Mesh.OptimizeNetgen", 1)
            gmsh.model.mesh.clear()
            gmsh.model.mesh.generate(3)
    except Exception as error:  # noqa: BLE001 - gmsh says what is wrong with the geometry
        return {"error": str(error)}
    gmsh.write(request["mesh"])
    return {"solids": 1, "size": size}


def _drawn(gmsh: Any, solid: int, request: dict[str, Any]) -> dict[str, Any]:
    """Return triangles between points of the surface, m; more than requested if it has many small faces.

    Equilateral triangles with edge h that cover the area S are 4 S/(sqrt(3) h^2).
    """
    corners = np.reshape(gmsh.model.getBoundingBox(3, solid), (2, 3))
    area, across = sum(_areas(gmsh, solid).values()), float(np.linalg.norm(corners[1] - corners[0]))
    size = max(np.sqrt(4.0 / np.sqrt(3.0) * area / request["triangles"]), across / DRAWN_ELEMENTS)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.ElementOrder", 1)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", DRAWN_A_TURN)
    gmsh.option.setNumber("Mesh.MeshSizeMin", across / DRAWN_SMALLEST)
    try:
        gmsh.model.mesh.generate(2)
    except Exception:  # noqa: BLE001 - its text may hold what is in the file
        return {"error": "gmsh does not mesh its faces"}
    tags, points, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(max(tags, default=0)) + 1, dtype=np.int64)  # row of a point by gmsh's tag
    number[tags] = np.arange(len(tags))
    _, _, nodes = gmsh.model.mesh.getElements(2)
    facets = [number[part].reshape(-1, 3).tolist() for part in nodes]
    points = MILLIMETER * np.reshape(points, (-1, 3))
    return {"solids": 1, "points": points.tolist(), "facets": [facet for part in facets for facet in part]}


def _wall_thickness(gmsh: Any, solid: int) -> float:
    """Return 2 V/S of a solid, the mean thickness of a thin-walled one, mm."""
    return 2.0 * float(gmsh.model.occ.getMass(3, solid)) / sum(_areas(gmsh, solid).values())


def _areas(gmsh: Any, solid: int) -> dict[int, float]:
    """Return the areas of the faces of a solid, mm^2."""
    faces = gmsh.model.getBoundary([(3, solid)], oriented=False)
    return {face: float(gmsh.model.occ.getMass(2, face)) for _, face in faces}


def _measured(gmsh: Any, solid: int, _: dict[str, Any]) -> dict[str, Any]:
    """Return volume, surface, flat faces and hollow faces of cylinders of a solid, m."""
    areas = _areas(gmsh, solid)
    planes, walls = [], []
    for face, area in areas.items():
        kind = gmsh.model.getType(2, face)
        if kind == "Plane":
            _, normals = _samples(gmsh, face)
            point = MILLIMETER * np.array(gmsh.model.occ.getCenterOfMass(2, face))
            planes.append((point.tolist(), normals[0].tolist(), area * MILLIMETER**2))
        elif kind == "Cylinder" and (wall := _wall(gmsh, face)) is not None:
            point, axis, radius, low, high = wall
            walls.append((point.tolist(), axis.tolist(), radius, area * MILLIMETER**2, low, high))
    volume = gmsh.model.occ.getMass(3, solid) * MILLIMETER**3
    surface = sum(areas.values()) * MILLIMETER**2
    return {"solids": 1, "volume": volume, "surface": surface, "planes": planes, "walls": walls}


def _samples(gmsh: Any, face: int) -> tuple[Any, Any]:
    """Return points (m) of the surface of a face and its outward normals, at a third and half of its turn."""
    (u, v), (u_end, v_end) = gmsh.model.getParametrizationBounds(2, face)
    middle = 0.5 * (v + v_end)
    at = [u + (u_end - u) / 3.0, middle, 0.5 * (u + u_end), middle]
    return (
        MILLIMETER * np.reshape(gmsh.model.getValue(2, face, at), (2, 3)),
        np.reshape(gmsh.model.getNormal(face, at), (2, 3)),
    )


def _wall(gmsh: Any, face: int) -> tuple[Any, Any, float, float, float] | None:
    """Return a point on the axis of a cylinder, its axis, its radius and the ends of the face; None: a boss.

    At points p of a boss of radius r about c the outward normals n are (p - c)/r, of a bore -(p - c)/r. So
    two points give p_1 - p_2 = +-r (n_1 - n_2), with the sign of a boss or a bore.
    """
    (first, second), (n, m) = _samples(gmsh, face)
    radius = float((first - second) @ (n - m) / ((n - m) @ (n - m)))
    if radius >= 0.0:
        return None
    axis = np.cross(n, m) / np.linalg.norm(np.cross(n, m))
    point = first - radius * n
    edge = MILLIMETER * np.vstack([_edge(gmsh, curve) for curve in _curves(gmsh, face)])
    along = (edge - point) @ axis
    return point, axis, -radius, float(along.min()), float(along.max())


def _curves(gmsh: Any, face: int) -> list[int]:
    return [curve for _, curve in gmsh.model.getBoundary([(2, face)], combined=False, oriented=False)]


def _edge(gmsh: Any, curve: int) -> Any:
    """Return points along a curve, mm."""
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
    return np.reshape(gmsh.model.getValue(1, curve, np.linspace(low, high, EDGE_POINTS).tolist()), (-1, 3))


def _main() -> None:
    """Answer the one request on standard input."""
    answer_to = os.dup(1)
    os.dup2(2, 1)  # whatever gmsh prints must not mix with the answer
    request = json.load(sys.stdin)
    end_after(int(request["seconds"]) + 1)  # ends this process even when its parent is gone
    confine(Path.cwd(), limits(request["seconds"]))
    try:
        answer = step_answer(request)
    except MemoryError:
        answer = {"error": "MemoryError"}
    except Exception:  # noqa: BLE001 - bare Exception is what gmsh raises; its text may hold what is in the file
        answer = {"error": "gmsh failed"}
    with os.fdopen(answer_to, "w") as stream:
        json.dump(answer, stream)


if __name__ == "__main__":
    _main()
