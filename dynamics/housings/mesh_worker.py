"""Child process that reads a mesh by meshio, one of Abaqus by meshlane, and does nothing else.

Run as a script by `dynamics.housings.mesh_files`, in a folder of its own, which is all that it can reach
(`host.confine`): both have readers of many formats, and some follow references to other files. A process
that is confined already calls `mesh_arrays` itself. The script reads one JSON object from standard input and
writes one to standard output, and the mesh as ``mesh.npz`` into its folder::

    {"file": "housing.msh", "format": "gmsh", "seconds": 60}
    {"groups": ["base", ...]}   or   {"unreadable": true}   or   {"cells": ["hexahedron"]}

The arrays are ``points``, ``tetrahedra`` (with four or ten nodes) and ``group_0`` ... (nodes of each group).
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host import confine, end_after

SURFACE_CELLS = ("triangle", "triangle6")
READERS = {"abaqus": "meshlane.abaqus"}  # meshio misplaces blocks of nodes and instances of Abaqus in silence
NODES = {"tetra": 4, "tetra10": 10}  # nodes of the kinds of tetrahedra
PHYSICAL, PROPERTY = "gmsh:physical", "nastran:ref"
Nodes = NDArray[np.int64]


class UnreadableMesh(Exception):
    """The file is not what its format says."""


class OtherCells(Exception):
    """The solid is not of one kind of tetrahedra."""


def mesh_arrays(file: Path, title: str) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Return the arrays of a file and the names of its groups."""
    reader = import_module(READERS.get(title, f"meshio.{title}"))
    try:
        content = reader.read(file)
    # what its readers raise on damaged or foreign files is not one class; some end the program
    except (Exception, SystemExit) as error:
        if isinstance(error, MemoryError):
            raise
        raise UnreadableMesh from None
    groups = dict(_named_parts(content))
    arrays = {f"group_{number}": nodes for number, nodes in enumerate(groups.values())}
    return arrays | {"points": content.points, "tetrahedra": _tetrahedra(content)}, list(groups)


def _tetrahedra(content: Any) -> Nodes:
    """Return the nodes of the tetrahedra of a file."""
    blocks: dict[str, list[Nodes]] = {}
    dimensions = {}
    for cells in content.cells:
        blocks.setdefault(cells.type, []).append(np.asarray(cells.data, dtype=np.int64))
        dimensions[cells.type] = cells.dim
    solid = sorted(kind for kind, dimension in dimensions.items() if dimension == 3)
    others = [kind for kind in solid if kind not in NODES]
    if others or len(solid) != 1:
        raise OtherCells(others or solid or list(blocks))
    nodes = np.vstack(blocks[solid[0]])
    if nodes.shape[1] != NODES[solid[0]]:
        raise UnreadableMesh
    return nodes


def _named_parts(content: Any) -> Iterator[tuple[str, Nodes]]:
    yield from ((name, np.asarray(nodes, dtype=np.int64)) for name, nodes in content.point_sets.items())
    for name, members in content.cell_sets.items():
        parts = [
            cells.data[np.asarray(member, dtype=np.int64)].ravel()
            for cells, member in zip(content.cells, members, strict=True)
            if cells.type in SURFACE_CELLS and member is not None and len(member)
        ]
        if parts and ":" not in name:  # names with a colon are those of the reader itself
            yield name, np.concatenate(parts)
    # number and dimension of each physical group; 2: a surface
    names = {int(value[0]): name for name, value in content.field_data.items() if int(value[1]) == 2}
    for key in (PHYSICAL, PROPERTY):
        for number, nodes in _by_number(content, key).items():
            name = names.get(number, str(number))
            # of an element in several groups the number is that of the first; its sets are complete
            if name not in content.cell_sets:
                yield name, nodes


def _by_number(content: Any, key: str) -> dict[int, Nodes]:
    numbered: dict[int, list[Nodes]] = {}
    for cells, numbers in zip(content.cells, content.cell_data.get(key, []), strict=False):
        if cells.type in SURFACE_CELLS:
            for number in np.unique(numbers):
                numbered.setdefault(int(number), []).append(cells.data[np.asarray(numbers) == number].ravel())
    return {number: np.concatenate(nodes) for number, nodes in numbered.items()}


def _main() -> None:
    """Answer the one request on standard input."""
    answer_to = os.dup(1)
    os.dup2(2, 1)  # whatever a reader prints must not mix with the answer
    request = json.load(sys.stdin)
    end_after(int(request["seconds"]) + 1)
    confine(Path.cwd())
    try:
        arrays, names = mesh_arrays(Path(request["file"]), request["format"])
        np.savez("mesh.npz", allow_pickle=False, **arrays)
        answer: dict[str, Any] = {"groups": names}
    except UnreadableMesh:
        answer = {"unreadable": True}
    except OtherCells as error:
        answer = {"cells": error.args[0]}
    except MemoryError:
        answer = {"error": "MemoryError"}
    with os.fdopen(answer_to, "w") as stream:
        json.dump(answer, stream)


if __name__ == "__main__":
    _main()
