"""Export of gear meshes through meshlane: VTU for viewers, msh for gmsh."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fe_contact.errors import InputError
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray, IntArray

FORMATS = {".vtu": "vtu", ".msh": "gmsh"}
HUB = -1_000_000  # stands for "no tooth" among the tooth numbers


def write_mesh(mesh: GearMesh, path: Path | str, point_data: Mapping[str, FloatArray] | None = None) -> None:
    """Write the mesh of a gear, in m, z = 0.

    Cells carry ``tooth`` (number of the tooth, `HUB` in the hub), nodes ``bore`` (1 on the bore).

    Parameters
    ----------
    mesh : GearMesh
        What to write.
    path : Path
        Its suffix decides the format: ``.vtu`` or ``.msh`` (gmsh 4.1).
    point_data : mapping, optional
        Further values per node, (n,) or (n, 3).

    Raises
    ------
    InputError
        The suffix is another one.
    """
    import meshlane  # noqa: PLC0415 - only who exports needs it

    path = Path(path)
    if path.suffix not in FORMATS:
        raise InputError("path", str(path), "a file name that ends in .vtu or .msh")
    bore = np.zeros(len(mesh.points))
    bore[mesh.bore_nodes] = 1.0
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    meshlane.Mesh(
        points,
        [("triangle6", mesh.triangles)],
        point_data={"bore": bore} | dict(point_data or {}),
        cell_data={"tooth": [cell_teeth(mesh).astype(float)]},
    ).write(path, file_format=FORMATS[path.suffix])


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

    Raises
    ------
    InputError
        The suffix is another one.
    """
    import meshlane  # noqa: PLC0415 - only who exports needs it

    path = Path(path)
    if path.suffix != ".vtu":
        raise InputError("path", str(path), "a file name that ends in .vtu")
    kind = {6: "triangle6", 20: "hexahedron20"}[cells.shape[1]]
    content = {name: [values] for name, values in cell_data.items()}
    draft = path.with_name(f".{path.name}.part")
    try:
        meshlane.Mesh(points, [(kind, cells)], dict(point_data), content).write(draft, file_format="vtu")
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
