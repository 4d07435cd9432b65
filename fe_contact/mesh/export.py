"""Elements with values as VTU for viewers, through meshio, and the teeth that elements belong to."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fe_contact.errors import InputError
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray, IntArray

HUB = -1_000_000  # stands for "no tooth" among the tooth numbers


def cell_teeth(mesh: GearMesh) -> IntArray:
    """Return the number of the tooth each triangle belongs to, (m,); `HUB` in the hub."""
    tooth = np.full(len(mesh.triangles), HUB)
    per_sector = len(mesh.sector.triangles)
    tooth[: per_sector * len(mesh.teeth)] = np.repeat(mesh.teeth, per_sector)
    return tooth


def write_cells(
    path: Path | str,
    points: FloatArray,
    cells: IntArray,
    point_data: Mapping[str, FloatArray],
    cell_data: Mapping[str, FloatArray | IntArray],
) -> None:
    """Write quadratic cells with values as VTU (binary, compressed), whole or not at all.

    Raises `InputError`: the suffix is another one.

    Parameters
    ----------
    path : Path
        Ends in ``.vtu``.
    points : (n, 3) array
        m.
    cells : (m, 6) or (m, 20) int array
        Triangles or hexahedra, numbered as in VTK.
    point_data, cell_data : mapping
        Values by name, of shape (n,), (n, 3) or (n, 6), and (m,).
    """
    import meshio  # noqa: PLC0415 - only who exports needs it

    path = Path(path)
    if path.suffix != ".vtu":
        raise InputError("path", str(path), "a file name that ends in .vtu")
    kind = {6: "triangle6", 20: "hexahedron20"}[cells.shape[1]]
    content = {name: [values] for name, values in cell_data.items()}
    draft = path.with_name(f".{path.name}.part")
    try:
        meshio.Mesh(points, [(kind, cells)], dict(point_data), content).write(draft, file_format="vtu")
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
