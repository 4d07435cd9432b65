"""Export of gear meshes through meshio: VTU for viewers, msh for gmsh."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fe_contact.errors import InputError
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray

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
    import meshio  # noqa: PLC0415 - only who exports needs it

    path = Path(path)
    if path.suffix not in FORMATS:
        raise InputError("path", str(path), "a file name that ends in .vtu or .msh")
    bore = np.zeros(len(mesh.points))
    bore[mesh.bore_nodes] = 1.0
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    tooth = np.full(len(mesh.triangles), float(HUB))
    per_sector = len(mesh.sector.triangles)
    tooth[: per_sector * len(mesh.teeth)] = np.repeat(mesh.teeth, per_sector)
    meshio.Mesh(
        points,
        [("triangle6", mesh.triangles)],
        point_data={"bore": bore} | dict(point_data or {}),
        cell_data={"tooth": [tooth]},
    ).write(path, file_format=FORMATS[path.suffix])
