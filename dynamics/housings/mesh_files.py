"""Volume meshes from files, by meshio in a child process, and the checks that they pass."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from bounds import from_to
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.housings.quadrature import determinants
from dynamics.housings.tetrahedral_mesh import EDGES, TetrahedralMesh, raised
from dynamics.mesh_content import check_mesh_content, mesh_text
from dynamics.solid_housing import MESH_FORMATS, MESH_SUFFIXES
from dynamics.types import FloatArray, IntArray
from host import READING, ChildFailed, ask_child
from host.optional_modules import csgraph
from host.optional_modules import sparse as sp

MIN_SHAPE = 0.02
"""Least `element_shape`, below which an element is a sliver: its volume over that of a regular tetrahedron
whose edges have the same mean square."""
SIZE = from_to(5e-3, 50.0, "m")
"""Plausible size of a housing: a mesh in another unit is out of it."""
FIELD = "mesh_file"
"""Field of errors."""
UNITS = {"m": 1.0, "mm": 1e-3}  # meters per unit of coordinates
_MESH_WORKER = Path(__file__).with_name("mesh_worker.py")
_MESH_SECONDS = 60.0  # most seconds in which the child process reads a file
LINEAR_NODES = 4  # nodes of a linear tetrahedron
TEXTS = ("Abaqus", "Nastran")
"""Formats of text, which is decoded before it is read."""
CORNERS = 3  # corners of a triangle


def element_shape(mesh: TetrahedralMesh) -> FloatArray:
    """Return 6 sqrt(2) V / l^3 of each element's corners, l the root mean square of its edges: 1 at best."""
    corner = mesh.points[mesh.tetrahedra[:, :4]]
    edge = corner[:, EDGES[:, 1]] - corner[:, EDGES[:, 0]]
    length = np.sqrt(np.mean(np.sum(edge**2, axis=2), axis=1))
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6.0
    return np.asarray(6.0 * np.sqrt(2.0) * volume / length**3)


def _check_quality(mesh: TetrahedralMesh) -> None:
    """Raise `InputError` for a mesh with slivers, folds or several parts, or with an implausible size."""
    extent = float(np.ptp(mesh.points, axis=0).max())
    if not SIZE.holds(extent):
        raise InputError(f"{FIELD}.size", extent, SIZE, 'Check the unit of the mesh: "m" or "mm".')
    shape = element_shape(mesh)
    if shape.min() < MIN_SHAPE:
        count, bound = int(np.sum(shape < MIN_SHAPE)), f"at least {MIN_SHAPE:g} (1: regular)"
        raise InputError(
            f"{FIELD}.shape", float(shape.min()), bound, f"{count} elements are slivers: mesh again."
        )
    folded = int(np.sum(determinants(mesh.points, mesh.tetrahedra).min(axis=1) <= 0.0))
    if folded:
        remedy = "Mid-side nodes fold them: refine where the surface is curved, or use straight edges."
        raise InputError(
            f"{FIELD}.elements", f"{folded} of {len(mesh.tetrahedra)} folded", "without folds", remedy
        )
    corners = mesh.tetrahedra[:, :4]
    row, column = np.repeat(corners[:, :1], 3, axis=1).ravel(), corners[:, 1:].ravel()
    graph = sp.coo_array((np.ones(len(row)), (row, column)), shape=2 * (len(mesh.points),))
    _, label = csgraph.connected_components(graph, directed=False)
    parts = np.unique(label[corners[:, 0]]).size
    if parts > 1:
        remedy = "Unite the bodies, or merge the nodes they share."
        raise InputError(f"{FIELD}.parts", parts, "1: one body whose elements share nodes", remedy)


class _Content(NamedTuple):
    """Content of a mesh file: points, nodes of its tetrahedra, nodes of the named parts of its surface."""

    points: FloatArray
    tetrahedra: IntArray
    groups: dict[str, IntArray]


def read_mesh(path: str | Path, unit: str) -> TetrahedralMesh:
    """Read a mesh of tetrahedra.

    Linear tetrahedra get mid-side nodes in the middle of their straight edges, because with their constant
    strain they are far too stiff. Named physical groups of triangles, node sets, element sets of triangles
    and Nastran properties of triangles (by number) become groups of nodes. Raises `InputError`: a missing
    file, no mesh, other solid elements than tetrahedra, or a bad mesh (see `_check_quality`).

    Parameters
    ----------
    path : str or Path
        ``.msh`` (gmsh), ``.inp`` (Abaqus, CalculiX), ``.bdf``, ``.nas``, ``.fem`` (Nastran), ``.vtu``,
        ``.vtk``.
    unit : str
        Unit of the coordinates, "m" or "mm": files do not state it.
    """
    scale = UNITS[one_of("unit", unit, list(UNITS))]
    return _checked_mesh(_content(Path(path)), scale)


def mesh_format(file: Path) -> str:
    """Return the format of a mesh by its suffix; raises `InputError`: no format, or no extra for it."""
    title = MESH_FORMATS[one_of(f"{FIELD}.suffix", file.suffix.lower(), MESH_SUFFIXES)]
    if title == "Abaqus" and find_spec("meshlane") is None:
        remedy = "pip install 'lineofaction[abaqus]', or write the mesh as gmsh (.msh)."
        raise InputError(FIELD, file.name, "read where the extra abaqus is installed", remedy)
    return title


def unreadable(file: Path, title: str) -> InputError:
    """Return the error of a file that is not what its format says."""
    remedy = "Export it again, or as gmsh (.msh)."
    if title == "gmsh":  # its reader wants a physical group of each element or of none
        remedy = "Save the elements of physical groups alone: Mesh.SaveAll = 0."
    return InputError(FIELD, file.name, f"a mesh as {title} writes it", remedy)


def _content(file: Path) -> _Content:
    """Return the content that a confined child reads from a file; the suffix alone decides the format."""
    title = mesh_format(file)
    if not file.is_file():
        raise InputError(FIELD, file.name, "a file that exists")
    content = file.read_bytes()
    check_mesh_content(file.name, content)
    with TemporaryDirectory() as name:
        copy = Path(name) / f"housing{file.suffix.lower()}"
        copy.write_bytes(mesh_text(content).read().encode() if title in TEXTS else content)
        request = {"file": copy.name, "format": title.lower()}
        try:
            command = (sys.executable, "-P", str(_MESH_WORKER))
            answer = ask_child(request, _MESH_SECONDS, command, copy.parent, READING)
        except ChildFailed as error:
            limits = f"{READING.memory_mb} MB of memory and {READING.cpu_seconds} s of CPU time"
            bound = f"a mesh that is read within {limits} (the reader: {error.cause})"
            raise InputError(FIELD, file.name, bound, "Write less into the file.") from None
        if answer.get("unreadable"):
            raise unreadable(file, title)
        if (cells := answer.get("cells")) is not None:
            bound = "tetrahedra alone, all with four or all with ten nodes"
            raise InputError(f"{FIELD}.cells", cells, bound, "Mesh with tetrahedra.")
        with np.load(copy.with_name("mesh.npz"), allow_pickle=False) as arrays:
            groups = {name: arrays[f"group_{number}"] for number, name in enumerate(answer["groups"])}
            return _Content(arrays["points"], arrays["tetrahedra"], groups)


def _checked_mesh(content: _Content, scale: float) -> TetrahedralMesh:
    points, tetrahedra = _quadratic(content)
    points = scale * np.asarray(points, dtype=float)
    if not np.all(np.isfinite(points)):
        raise InputError(FIELD, "with coordinates that are no numbers", "finite coordinates")
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    groups = {name: number[nodes] for name, nodes in content.groups.items()}
    node_groups = {name: np.unique(nodes[nodes >= 0]) for name, nodes in groups.items()}
    mesh = TetrahedralMesh(points[used], tetrahedra.reshape(-1, 10), node_groups)
    _check_quality(mesh)
    return mesh


def _quadratic(content: _Content) -> tuple[FloatArray, IntArray]:
    """Return points and tetrahedra with ten nodes; linear ones get mid-side nodes."""
    points, cells = content.points, content.tetrahedra
    members = [cells, *content.groups.values()]
    if any(nodes.min(initial=0) < 0 or nodes.max(initial=0) >= len(points) for nodes in members):
        raise InputError(FIELD, "with elements that lack nodes", "complete, as its reader finds it")
    if cells.shape[1] != LINEAR_NODES:
        return points, cells
    corner = points[cells]
    inverted = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0.0  # negative volume: two corners exchanged
    return raised(np.where(inverted[:, None], cells[:, [0, 2, 1, 3]], cells), points)
