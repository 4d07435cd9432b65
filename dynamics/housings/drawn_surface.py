"""Surfaces of housings as a picture shows them: coarse triangles of a STEP file or of a mesh, not reduced.

For a process that is confined already (`host.confine`) and answers once: gmsh and meshlane run in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from bounds import from_to
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.housings.mesh_files import SIZE, TEXTS, UNITS
from dynamics.housings.mesh_worker import OtherCells, UnreadableMesh, mesh_arrays
from dynamics.housings.step_worker import step_answer
from dynamics.housings.tetrahedral_mesh import FACES
from dynamics.solid_housing import MESH_FORMATS, MESH_SUFFIXES, mesh_text
from dynamics.types import FloatArray, IntArray

MOST_TRIANGLES = 20_000
WANTED_TRIANGLES = 6_000
"""Of a solid without small faces."""
_FARTHEST = from_to(0.0, 1e3, "m")
_FINEST, _COARSER, _LEAST_AREA = 0.8, 1.08, 1e-9
"""Size of cells in which points are put together, over that of as many facets as are allowed; how much larger
they are next; least area of a facet over theirs."""
_AGAINST, _BESIDE = -0.3, 1e-3
"""Normal of another skin along that of the outermost one; weight of the middle of a cell among its points."""


@dataclass(frozen=True)
class DrawnSurface:
    """Triangles that bound a body: points in m, (p, 3), and three of them a facet, (t, 3)."""

    points: FloatArray
    facets: IntArray

    def of_at_most(self, most: int) -> tuple[DrawnSurface, IntArray]:
        """Return it with at most so many triangles, and which of its points that one has.

        Points near each other are put together, of a thin wall those of either skin.
        """
        kept, facets = np.arange(len(self.points)), self.facets
        size = _FINEST * float(np.sqrt(np.linalg.norm(_across(self.points[facets]), axis=1).sum() / most))
        while len(facets) > most:
            kept, facets = self._together(size)
            size *= _COARSER
        return DrawnSurface(self.points[kept], facets), kept

    def _together(self, size: float) -> tuple[IntArray, IntArray]:
        """Put points of one skin in a cell of a grid together in that which is least off all their facets.

        So edges stay, and sides stay flat. Of one skin is what hangs together in the cell and has no normal
        against that of its outermost point. Facets without area go. Returns the points that are kept and the
        facets between them.
        """
        points, facets = self.points, self.facets
        low, high = points.min(axis=0), points.max(axis=0)
        cells = np.floor((points - low) / size).astype(np.int64)
        one, two = facets.ravel(), np.roll(facets, -1, axis=1).ravel()
        within = np.all(cells[one] == cells[two], axis=1)
        links = csr_array((within[within], (one[within], two[within])), shape=(len(points), len(points)))
        part = connected_components(links, directed=False)[1].astype(np.int64)
        outermost = _least(-np.linalg.norm(points - 0.5 * (low + high), axis=1), part)
        normal = node_normals(points, facets)
        against = np.sum(normal * normal[outermost], axis=1) < _AGAINST
        _, skin = np.unique(2 * part + against, return_inverse=True)
        kept, skin = np.unique(_least(self._off(skin), skin), return_inverse=True)
        corners = skin[facets]
        whole = np.linalg.norm(_across(points[kept][corners]), axis=1) > _LEAST_AREA * size**2
        _, first = np.unique(np.sort(corners[whole], axis=1), axis=0, return_index=True)
        return kept, corners[whole][np.sort(first)]

    def _off(self, group: IntArray) -> FloatArray:
        """Return how far points (p,) are off the planes of all facets of their group, squares by areas [1]_.

        In a plane all are as far: that in the middle counts as nearest.

        .. [1] Garland, Heckbert: "Surface simplification using quadric error metrics", SIGGRAPH 1997.
        """
        points, across, count = self.points, _across(self.points[self.facets]), int(group.max()) + 1
        area = np.linalg.norm(across, axis=1)
        normal = across / np.maximum(area, np.finfo(float).tiny)[:, None]
        plane = np.column_stack([normal, -np.sum(normal * points[self.facets[:, 0]], axis=1)])
        squares = area[:, None, None] * plane[:, :, None] * plane[:, None, :]
        square = _at_corners(group[self.facets], squares.reshape(-1, 16), count).reshape(-1, 4, 4)[group]
        ahead = np.column_stack([points, np.ones(len(points))])
        whole = _at_corners(group[:, None], ahead, count)[group]
        beside = np.sum((points - whole[:, :3] / whole[:, 3:]) ** 2, axis=1)
        off = np.einsum("pi,pij,pj->p", ahead, square, ahead)
        return np.asarray(off + _BESIDE * np.trace(square[:, :3, :3], axis1=1, axis2=2) * beside)


def node_normals(points: FloatArray, facets: IntArray) -> FloatArray:
    """Return the normals of length 1 of nodes, in the mean of the facets at each by their areas."""
    normals = _at_corners(facets, _across(points[facets]), len(points))
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None])


def _across(corners: FloatArray) -> FloatArray:
    """Return normals (t, 3) of facets by their corners (t, 3, 3), as long as twice the area."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _at_corners(corners: IntArray, values: FloatArray, count: int) -> FloatArray:
    """Return the sums (g, k) of the values (t, k) of all that have a corner (t, c) at each of so many."""
    rows, columns = corners.ravel(), np.repeat(np.arange(len(corners)), corners.shape[1])
    return np.asarray(csr_array((np.ones(rows.size), (rows, columns)), shape=(count, len(corners))) @ values)


def _least(value: FloatArray, group: IntArray) -> IntArray:
    """Return for each point (p,) that of its group whose value is least."""
    order = np.lexsort((value, group))
    first = np.flatnonzero(np.diff(group[order], prepend=-1))
    return np.asarray(order[first][group])


def drawn_step(file: Path, most: int = MOST_TRIANGLES) -> DrawnSurface:
    """Return the surface of the one solid in a STEP file.

    Raises `InputError`: no solid or several, faces that gmsh does not mesh, or the size of no housing.
    """
    request = {"step": str(file), "mesh": None, "triangles": min(WANTED_TRIANGLES, most)}
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
        advice = "Unite the solids in the CAD program."
        raise InputError("step_file.solids", answer["solids"], "one solid", advice)
    facets = np.array(answer["facets"], dtype=np.int64).reshape(-1, 3)
    return _drawn(np.array(answer["points"]), facets, most, "step_file")


def drawn_mesh(file: Path, unit: str, most: int = MOST_TRIANGLES) -> DrawnSurface:
    """Return the surface of a mesh of tetrahedra, straight between their corners; `unit`: "m" or "mm".

    Raises `InputError`: no mesh of its format, other solid elements, or the size of no housing.
    """
    title = MESH_FORMATS[one_of("mesh_file.suffix", file.suffix.lower(), MESH_SUFFIXES)]
    if title in TEXTS:
        file.write_text(mesh_text(file.read_bytes()).read(), encoding="utf-8")
    try:
        arrays, _ = mesh_arrays(file, title.lower())
    except UnreadableMesh:
        bound, advice = f"a mesh as {title} writes it", "Export it again, or as gmsh (.msh)."
        raise InputError("mesh_file", file.name, bound, advice) from None
    except OtherCells as error:
        bound = "tetrahedra alone, all with four or all with ten nodes"
        raise InputError("mesh_file.cells", error.args[0], bound, "Mesh with tetrahedra.") from None
    points, corners = np.asarray(arrays["points"], dtype=float), arrays["tetrahedra"][:, :4]
    if corners.min(initial=0) < 0 or corners.max(initial=0) >= len(points):
        raise InputError("mesh_file", "with elements that lack nodes", "complete, as meshlane reads it")
    return _drawn(UNITS[unit] * points, _bounding(corners), most, "mesh_file")


def _bounding(tetrahedra: IntArray) -> IntArray:
    """Return the faces (t, 3) that one tetrahedron alone has."""
    faces = tetrahedra[:, FACES[:, :3]].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(faces[first[count == 1]])


def _drawn(points: FloatArray, facets: IntArray, most: int, field: str) -> DrawnSurface:
    """Return a surface of at most so many triangles, which is near the origin and as large as a housing."""
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
    return DrawnSurface(points, facets).of_at_most(most)[0]
