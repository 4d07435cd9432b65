"""Files of surfaces with fields at their nodes and triangles, as VTU."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from dynamics.housings.mesh_files import CORNERS
from dynamics.types import FloatArray, IntArray


def write_surface(
    path: str | Path,
    points: FloatArray,
    triangles: IntArray,
    fields: Mapping[str, FloatArray],
    of_triangles: Mapping[str, FloatArray] | None = None,
) -> None:
    """Write triangles with fields as VTU; the file appears whole or not at all.

    Parameters
    ----------
    points : (p, 3) array
        m.
    triangles : (t, 3) or (t, 6) int array
        Corners, then mid-side nodes.
    fields : mapping of str to (p,) or (p, 3) array
        Values at the nodes.
    of_triangles : mapping of str to (t,) array, optional
        Constant on triangles.
    """
    import meshio  # noqa: PLC0415 (start-up time)

    file = Path(path)
    mesh = meshio.Mesh(
        points,
        [("triangle" if triangles.shape[1] == CORNERS else "triangle6", triangles)],
        point_data={name: np.ascontiguousarray(values) for name, values in fields.items()},
        cell_data={name: [np.ascontiguousarray(values)] for name, values in (of_triangles or {}).items()},
    )
    unfinished = file.with_name(f".{file.name}.{os.getpid()}")
    try:
        meshio.write(unfinished, mesh, file_format="vtu")
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)
