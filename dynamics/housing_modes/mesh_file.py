"""Volume meshes from files, by meshlane in a child process."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.housing_modes.mesh_quality import FIELD, check_quality
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh, raised
from dynamics.solid_housing import MESH_FORMATS, MESH_SUFFIXES, check_mesh_content, mesh_text
from dynamics.types import FloatArray, IntArray
from host import READING, ChildFailed, ask_child

UNITS = {"m": 1.0, "mm": 1e-3}
WORKER = Path(__file__).with_name("mesh_worker.py")
SECONDS = 60.0
LINEAR_NODES = 4
TEXTS = ("Abaqus", "Nastran")


class Content(NamedTuple):
    """What a file holds: points, nodes of its tetrahedra, nodes of the named parts of its surface."""

    points: FloatArray
    tetrahedra: IntArray
    groups: dict[str, IntArray]


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


def _content(file: Path) -> Content:
    """Return what a confined child reads from a file: its format is by the suffix, and never another."""
    title = MESH_FORMATS[one_of(f"{FIELD}.suffix", file.suffix.lower(), MESH_SUFFIXES)]
    if not file.is_file():
        raise InputError(FIELD, file.name, "a file that exists")
    content = file.read_bytes()
    check_mesh_content(file.name, content)
    with TemporaryDirectory() as name:
        copy = Path(name) / f"housing{file.suffix.lower()}"
        copy.write_bytes(mesh_text(content).read().encode() if title in TEXTS else content)
        request = {"file": copy.name, "format": title.lower()}
        try:
            answer = ask_child(request, SECONDS, (sys.executable, "-P", str(WORKER)), copy.parent)
        except ChildFailed as error:
            limits = f"{READING.memory_mb} MB of memory and {READING.cpu_seconds} s of CPU time"
            bound = f"a mesh that is read within {limits} (the reader: {error.cause})"
            raise InputError(FIELD, file.name, bound, "Write less into the file.") from None
        if answer.get("unreadable"):
            bound, advice = f"a mesh as {title} writes it", "Export it again, or as gmsh (.msh)."
            raise InputError(FIELD, file.name, bound, advice)
        if (cells := answer.get("cells")) is not None:
            bound = "tetrahedra alone, all with four or all with ten nodes"
            raise InputError(f"{FIELD}.cells", cells, bound, "Mesh with tetrahedra.")
        with np.load(copy.with_name("mesh.npz"), allow_pickle=False) as arrays:
            groups = {name: arrays[f"group_{number}"] for number, name in enumerate(answer["groups"])}
            return Content(arrays["points"], arrays["tetrahedra"], groups)


def _checked(content: Content, scale: float) -> TetrahedralMesh:
    """Return the mesh of a file."""
    points, tetrahedra = _quadratic(content)
    points = scale * np.asarray(points, dtype=float)
    if not np.all(np.isfinite(points)):
        raise InputError(FIELD, "with coordinates that are no numbers", "finite coordinates")
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    groups = {name: number[nodes] for name, nodes in content.groups.items()}
    whole = {name: np.unique(nodes[nodes >= 0]) for name, nodes in groups.items()}
    mesh = TetrahedralMesh(points[used], tetrahedra.reshape(-1, 10), whole)
    check_quality(mesh)
    return mesh


def _quadratic(content: Content) -> tuple[FloatArray, IntArray]:
    """Return points and tetrahedra with ten nodes, linear ones raised."""
    points, cells = content.points, content.tetrahedra
    members = [cells, *content.groups.values()]
    if any(nodes.min(initial=0) < 0 or nodes.max(initial=0) >= len(points) for nodes in members):
        raise InputError(FIELD, "with elements that lack nodes", "complete, as meshlane reads it")
    return raised(_right_handed(points, cells), points) if cells.shape[1] == LINEAR_NODES else (points, cells)


def _right_handed(points: FloatArray, corners: IntArray) -> IntArray:
    """Turn linear tetrahedra of negative volume round."""
    corner = points[corners]
    turned = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0.0
    return np.where(turned[:, None], corners[:, [0, 2, 1, 3]], corners)
