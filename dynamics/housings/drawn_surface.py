"""Surfaces of housings as a picture shows them: coarse triangles of a STEP file or of a mesh, not reduced.

For a process that is confined already (`host.confine`) and answers once: gmsh and meshlane run in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

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
_FINEST_GRID, _COARSER, _LEAST_AREA = 256.0, 0.8, 1e-9
"""Cells across a surface, in each its points are put together; how many fewer next; least area of a facet."""


@dataclass(frozen=True)
class DrawnSurface:
    """Triangles that bound a body: points in m, (p, 3), and three of them a facet, (t, 3)."""

    points: FloatArray
    facets: IntArray

    def of_at_most(self, most: int) -> tuple[DrawnSurface, IntArray]:
        """Return it with at most so many triangles, and which of its points that one has.

        Points near each other are put together.
        """
        kept, facets = np.arange(len(self.points)), self.facets
        extent, cells = float(np.ptp(self.points, axis=0).max()), _FINEST_GRID
        while len(facets) > most:
            outermost, facets = _together(self.points[kept], facets, extent / cells)
            kept = kept[outermost]
            cells *= _COARSER
        return DrawnSurface(self.points[kept], facets), kept


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


def _together(points: FloatArray, facets: IntArray, size: float) -> tuple[IntArray, IntArray]:
    """Put points in a cell of a grid together in the outermost, so edges stay.

    Facets without area go, and of a wall that is thinner than a cell the side towards the middle.
    Returns the outermost of each cell and the facets between them.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle, cells = 0.5 * (low + high), np.floor((points - low) / size).astype(np.int64)
    _, cell, count = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    cell = cell.ravel()
    outwards = np.lexsort((np.linalg.norm(points - middle, axis=1), cell))
    outermost = outwards[np.cumsum(count) - 1]
    one, two, three = np.moveaxis(points[outermost][cell[facets]], 1, 0)
    across = np.cross(two - one, three - one)
    whole = np.flatnonzero(np.linalg.norm(across, axis=1) > _LEAST_AREA * size**2)
    inwards = np.sum(across * (one - middle), axis=1)[whole] <= 0.0
    facets = cell[facets[whole[np.argsort(inwards, kind="stable")]]]
    _, first = np.unique(np.sort(facets, axis=1), axis=0, return_index=True)
    return outermost, facets[np.sort(first)]
