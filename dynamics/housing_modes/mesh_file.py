"""Volume meshes from files, by meshio."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.housing_modes.mesh_quality import FIELD, check_quality
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh, raised
from dynamics.solid_housing import MESH_SUFFIXES
from dynamics.types import FloatArray, IntArray

UNITS = {"m": 1.0, "mm": 1e-3}
SURFACE_CELLS = ("triangle", "triangle6")
NODES = {"tetra": 4, "tetra10": 10}
PHYSICAL, PROPERTY = "gmsh:physical", "nastran:ref"


def read_mesh(path: str | Path, unit: str) -> TetrahedralMesh:
    """Read a mesh of tetrahedra.

    Linear tetrahedra get mid-side nodes in the middle of their straight edges: their own strain is constant
    and far too stiff. Named physical groups of triangles, node sets, element sets of triangles and Nastran
    properties of triangles (by number) are kept as groups of nodes.

    Parameters
    ----------
    path : str or Path
        ``.msh`` (gmsh), ``.inp`` (Abaqus, CalculiX), ``.bdf``, ``.nas``, ``.fem`` (Nastran), ``.vtu``,
        ``.vtk``.
    unit : str
        Of its coordinates, "m" or "mm": files do not say it.

    Raises
    ------
    InputError
        No such file, no mesh, other solid elements than tetrahedra, or a bad mesh (see `check_quality`).
    """
    scale = UNITS[one_of("unit", unit, list(UNITS))]
    return _checked(_content(Path(path)), scale)


def _content(file: Path) -> Any:
    """Return a file as meshio reads it."""
    import meshio  # noqa: PLC0415 (start-up time)

    one_of(f"{FIELD}.suffix", file.suffix.lower(), MESH_SUFFIXES)
    if not file.is_file():
        raise InputError(FIELD, str(file), "a file that exists")
    try:
        return meshio.read(file)
    # what its readers raise on damaged or foreign files is not one class; some end the program
    except (Exception, SystemExit) as error:
        raise InputError(FIELD, str(file), f"a mesh that meshio reads ({error})") from error


def _checked(content: Any, scale: float) -> TetrahedralMesh:
    """Return the mesh of a file."""
    points, tetrahedra = _quadratic(content)
    points = scale * np.asarray(points, dtype=float)
    if not np.all(np.isfinite(points)):
        raise InputError(FIELD, "with coordinates that are no numbers", "finite coordinates")
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    groups = {name: number[nodes] for name, nodes in _groups(content)}
    whole = {name: np.unique(nodes[nodes >= 0]) for name, nodes in groups.items()}
    mesh = TetrahedralMesh(points[used], tetrahedra.reshape(-1, 10), whole)
    check_quality(mesh)
    return mesh


def _quadratic(content: Any) -> tuple[FloatArray, IntArray]:
    """Return points and tetrahedra with ten nodes, linear ones raised."""
    from meshio import CellBlock  # noqa: PLC0415 (start-up time)

    blocks: dict[str, list[IntArray]] = {}
    for cells in content.cells:
        assert isinstance(cells, CellBlock)
        blocks.setdefault(cells.type, []).append(np.asarray(cells.data, dtype=np.int64))
    solid = sorted(kind for kind, found in blocks.items() if CellBlock(kind, found[0]).dim == 3)
    others = [kind for kind in solid if kind not in NODES]
    if others or len(solid) != 1:
        bound = "tetrahedra alone, all with four or all with ten nodes"
        raise InputError(f"{FIELD}.cells", others or solid or list(blocks), bound, "Mesh with tetrahedra.")
    cells = np.vstack(blocks[solid[0]])
    if cells.shape[1] != NODES[solid[0]] or cells.min() < 0 or cells.max() >= len(content.points):
        raise InputError(FIELD, "with elements that lack nodes", "complete, as meshio reads it")
    if solid[0] == "tetra":
        return raised(_right_handed(content.points, cells), content.points)
    return content.points, cells


def _right_handed(points: FloatArray, corners: IntArray) -> IntArray:
    """Turn linear tetrahedra of negative volume round."""
    corner = points[corners]
    turned = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0.0
    return np.where(turned[:, None], corners[:, [0, 2, 1, 3]], corners)


def _groups(content: Any) -> Iterator[tuple[str, IntArray]]:
    """Yield the nodes of named parts of the surface."""
    yield from ((name, np.asarray(nodes, dtype=np.int64)) for name, nodes in content.point_sets.items())
    for name, members in content.cell_sets.items():
        parts = [
            cells.data[np.asarray(member, dtype=np.int64)].ravel()
            for cells, member in zip(content.cells, members, strict=True)
            if cells.type in SURFACE_CELLS and member is not None and len(member)
        ]
        if parts and ":" not in name:
            yield name, np.concatenate(parts)
    names = {int(value[0]): name for name, value in content.field_data.items() if int(value[1]) == 2}
    for key in (PHYSICAL, PROPERTY):
        for number, nodes in _by_number(content, key).items():
            yield names.get(number, str(number)), nodes


def _by_number(content: Any, key: str) -> dict[int, IntArray]:
    """Return the nodes of triangles by a number that the file has for each."""
    numbered: dict[int, list[IntArray]] = {}
    for cells, numbers in zip(content.cells, content.cell_data.get(key, []), strict=False):
        if cells.type in SURFACE_CELLS:
            for number in np.unique(numbers):
                numbered.setdefault(int(number), []).append(cells.data[np.asarray(numbers) == number].ravel())
    return {number: np.concatenate(nodes) for number, nodes in numbered.items()}
