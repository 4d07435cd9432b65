"""Surfaces of housings as a picture shows them: coarse triangles of a STEP file or of a mesh.

For a process that is confined already (`host.confine`) and answers once: gmsh and mesh readers run in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bounds import at_most, from_to
from dynamics.errors import InputError
from dynamics.housings.mesh_files import SIZE, TEXTS, UNITS, mesh_format, unreadable
from dynamics.housings.mesh_worker import OtherCells, UnreadableMesh, mesh_arrays
from dynamics.housings.step_worker import step_answer
from dynamics.housings.tetrahedral_mesh import FACES
from dynamics.mesh_content import mesh_text
from dynamics.types import FloatArray, IntArray
from host.optional_modules import fast_simplification, sparse, spatial

MAX_TRIANGLES = 20_000  # largest number of triangles of a drawn surface
WANTED_TRIANGLES = 6_000
"""Most triangles of a drawn solid without small faces; a solid with them may have up to the maximum."""
_FARTHEST = from_to(0.0, 1e3, "m")
_AGGRESSIVENESS = 3.0, 5.0, 7.0
"""Aggressiveness of the tries of the mesh reduction: the first keeps shapes best, the last closes bores where
too many triangles are left.
"""
_NORMAL_WEIGHT = 0.2
"""Weight of unit normals in the search for the nearest node, over the size of a facet."""
_MIN_AREA = 1e-6
"""Least area of a facet over the mean area."""


@dataclass(frozen=True)
class DrawnSurface:
    """Triangles that bound a body: points in m, (p, 3), and three of them a facet, (t, 3)."""

    points: FloatArray
    facets: IntArray

    def reduced(self, maximum: int) -> tuple[DrawnSurface, IntArray]:
        """Return the surface with at most `maximum` triangles, and the indices of the points that it keeps.

        Each edge collapses to the point with the least distance from the planes around the edge [1]_. The
        nearest point of the surface whose normal agrees takes its place. More triangles are left if the
        triangles do not hang together.

        .. [1] Garland, Heckbert: "Surface simplification using quadric error metrics", SIGGRAPH 1997.
        """
        corners = self.facets
        for aggressiveness in _AGGRESSIVENESS:
            if len(corners) <= maximum:
                break
            points, facets = fast_simplification.simplify(
                self.points, self.facets, target_count=maximum, agg=aggressiveness
            )
            weight = _NORMAL_WEIGHT * float(np.linalg.norm(_across(points[facets]), axis=1).mean() ** 0.5)
            simplified = np.hstack([points, weight * node_normals(points, facets)])
            descriptors = np.hstack([self.points, weight * node_normals(self.points, self.facets)])
            corners = np.asarray(spatial.cKDTree(descriptors).query(simplified)[1])[facets]
        area = np.linalg.norm(_across(self.points[corners]), axis=1)
        retained, facets = np.unique(corners[area > _MIN_AREA * area.mean()], return_inverse=True)
        return DrawnSurface(self.points[retained], facets.reshape(-1, 3)), retained


def node_normals(points: FloatArray, facets: IntArray) -> FloatArray:
    """Return the normals of length 1 of nodes, in the mean of the facets at each by their areas."""
    normals = _at_corners(facets, _across(points[facets]), len(points))
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None])


def _across(corners: FloatArray) -> FloatArray:
    """Return normals (t, 3) of facets by their corners (t, 3, 3), as long as twice the area."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _at_corners(corners: IntArray, values: FloatArray, count: int) -> FloatArray:
    """Return sums (g, k) of values (t, k) of the facets that meet at each of `count` = g points.

    The points of the facets are `corners` (t, c).
    """
    rows, columns = corners.ravel(), np.repeat(np.arange(len(corners)), corners.shape[1])
    return np.asarray(
        sparse.csr_array((np.ones(rows.size), (rows, columns)), shape=(count, len(corners))) @ values
    )


def drawn_step(file: Path, maximum: int = MAX_TRIANGLES) -> DrawnSurface:
    """Return the surface of the one solid in a STEP file.

    Raises `InputError`: no solid or several, faces that gmsh does not mesh, or the size of no housing.
    """
    request = {"step": str(file), "mesh": None, "triangles": min(WANTED_TRIANGLES, maximum)}
    try:
        answer = step_answer(request)
    except MemoryError:
        raise
    except Exception:  # noqa: BLE001 (what gmsh raises; its text may hold what is in the file)
        answer = {"error": "gmsh failed"}
    if "error" in answer:
        bound = f"a solid that can be drawn ({answer['error']})"
        raise InputError("step_file", file.name, bound, "Heal the geometry, or export it again.")
    if answer["solids"] != 1:
        remedy = "Unite the solids in the CAD program."
        raise InputError("step_file.solids", answer["solids"], "one solid", remedy)
    facets = np.array(answer["facets"], dtype=np.int64).reshape(-1, 3)
    return _drawn_surface(np.array(answer["points"]), facets, maximum, "step_file")


def drawn_mesh(file: Path, unit: str, maximum: int = MAX_TRIANGLES) -> DrawnSurface:
    """Return the surface of a mesh of tetrahedra, straight between their corners; `unit`: "m" or "mm".

    Raises `InputError`: no mesh of its format, other solid elements, or the size of no housing.
    """
    title = mesh_format(file)
    if title in TEXTS:
        file.write_text(mesh_text(file.read_bytes()).read(), encoding="utf-8")
    try:
        arrays, _ = mesh_arrays(file, title.lower())
    except UnreadableMesh:
        raise unreadable(file, title) from None
    except OtherCells as error:
        bound = "tetrahedra alone, all with four or all with ten nodes"
        raise InputError("mesh_file.cells", error.args[0], bound, "Mesh with tetrahedra.") from None
    points, corners = np.asarray(arrays["points"], dtype=float), arrays["tetrahedra"][:, :4]
    if corners.min(initial=0) < 0 or corners.max(initial=0) >= len(points):
        raise InputError("mesh_file", "with elements that lack nodes", "complete, as its reader finds it")
    return _drawn_surface(UNITS[unit] * points, _bounding(corners), maximum, "mesh_file")


def _bounding(tetrahedra: IntArray) -> IntArray:
    """Return the faces (t, 3) that one tetrahedron alone has."""
    faces = tetrahedra[:, FACES[:, :3]].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(faces[first[count == 1]])


def _drawn_surface(points: FloatArray, facets: IntArray, maximum: int, field: str) -> DrawnSurface:
    """Return a surface of at most `maximum` triangles; it is near the origin and as large as a housing."""
    used, facets = np.unique(facets, return_inverse=True)
    points, facets = points[used], facets.reshape(-1, 3)
    if not len(facets):
        raise InputError(field, "without faces", "a solid with a surface")
    if not np.all(np.isfinite(points)):
        raise InputError(field, "with coordinates that are no numbers", "finite coordinates")
    farthest, extent = float(np.abs(points).max()), float(np.ptp(points, axis=0).max())
    if not _FARTHEST.holds(farthest):
        raise InputError(f"{field}.place", farthest, _FARTHEST, "Move the solid to its origin.")
    if not SIZE.holds(extent):
        raise InputError(f"{field}.size", extent, SIZE, "Check its unit.")
    drawn, _ = DrawnSurface(points, facets).reduced(maximum)
    if len(drawn.facets) > maximum:
        raise InputError(f"{field}.facets", len(drawn.facets), at_most(maximum), "Leave out small parts.")
    return drawn
