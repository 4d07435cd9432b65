"""Stiffness of a swept tooth sector: hexahedra, nodes that hang on coarser faces, frames of the flanks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementHexS2, MeshHex
from skfem.quadrature import get_quadrature

from fe_contact.body import BoreSeat
from fe_contact.compliance.plane_elasticity import PlaneHypothesis, element_stiffness
from fe_contact.errors import MeshError
from fe_contact.geometry import Toothing
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.swept_sector import LOWER_FACE, Batch, SweptSector
from fe_contact.types import FloatArray, IntArray

# Stiffness of 20-node hexahedra between turned copies of a section, by scikit-fem's serendipity element.


# Reference coordinates of the nodes: bottom corners, top corners, bottom middles, top middles, uprights.
_RING = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
_SIDES = [(0, -1), (1, 0), (0, 1), (-1, 0)]
REFERENCE = np.array(
    [(x, y, z) for ring in (_RING, _SIDES) for z in (-1, 1) for x, y in ring] + [(x, y, 0) for x, y in _RING],
    dtype=float,
)
SECTION = np.array([0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 0, 1, 2, 3])
"""Node of the quadrilateral that each node of the hexahedron stands above."""
QUADRATURE_ORDER = 5  # three Gauss points each way
_APART = np.abs(ElementHexS2.doflocs[:, None] - 0.5 * (REFERENCE + 1.0)).sum(axis=2)
_NODE, _FUNCTION = _APART.argmin(axis=1), _APART.argmin(axis=0)  # of scikit-fem's functions, and back


def _layer_nodes(section: FloatArray, thickness: float, turn: float) -> FloatArray:
    """Return the nodes (m, 20, 3) of the hexahedra between two turned copies of quadrilaterals, m.

    `section` (m, 8, 2) has corners counter-clockwise and middles of sides 0-1, 1-2, 2-3, 3-0 at the
    middle of the layer, where z = 0. Its top is turned against its bottom by `turn` in rad.
    """
    return above(section[:, SECTION], 0.5 * REFERENCE[:, 2], thickness, turn)


def above(points: FloatArray, level: FloatArray, thickness: float, turn: float) -> FloatArray:
    """Return section points (m, p, 2) swept along the helix to the levels (p,), in layers: (m, p, 3)."""
    x, y = points[..., 0], points[..., 1]
    c, s = np.cos(turn * level), np.sin(turn * level)
    return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(thickness * level, x.shape)], axis=-1)


def hexahedra(nodes: FloatArray) -> MeshHex:
    """Return scikit-fem's mesh of hexahedra apart from each other with `nodes` (m, 20, 3) in m."""
    numbers = np.arange(20 * len(nodes)).reshape(-1, 20)
    return MeshHex(nodes.reshape(-1, 3).T, numbers[:, _NODE].T, elem=ElementHexS2)


def determinants(mesh: MeshHex, at: FloatArray) -> FloatArray:
    """Return the determinants (m, q) of the map from scikit-fem's cube, 0 to 1 each way, at points (3, q)."""
    rows = mesh.mapping().DF(at)
    return np.asarray(np.sum(rows[0] * np.cross(rows[1], rows[2], axis=0), axis=0))


def gradients(mesh: MeshHex, at: FloatArray) -> FloatArray:
    """Return the gradients (m, q, 20, 3) of the functions at points (3, q) of that cube."""
    basis = Basis(mesh, ElementHexS2(), quadrature=(at, np.ones(at.shape[1])), disable_doflocs=True)
    return np.stack([basis.basis[i][0].grad for i in _FUNCTION]).transpose(2, 3, 0, 1)


def _stiffness_of(nodes: FloatArray, lame: tuple[float, float]) -> FloatArray:
    """Return the stiffness (m, 60, 60) of hexahedra with `nodes` (m, 20, 3) in m as in `REFERENCE`, N/m.

    Freedom 3 i + c is the Cartesian component c of node i; `lame` are lambda and mu, Pa. Raises `MeshError`:
    an element is folded.
    """
    mesh = hexahedra(nodes)
    least = determinants(mesh, get_quadrature(ElementHexS2, QUADRATURE_ORDER)[0]).min(axis=1)
    if not least.min() > 0.0:
        worst = int(least.argmin())
        x, y = 1e3 * nodes[worst, :, :2].mean(axis=0)
        raise MeshError(
            f"tooth sector: element {worst} at ({x:.4g}, {y:.4g}) mm is folded. "
            "Try other element sizes in the sector recipe."
        )
    freedoms = (3 * _FUNCTION[:, None] + np.arange(3)).ravel()
    return element_stiffness(mesh, QUADRATURE_ORDER, lame)[:, freedoms[:, None], freedoms]


def cylindrical_frames(nodes: FloatArray) -> FloatArray:
    """Return the frames (m, p, 3, 3) at nodes (m, p, 3): columns radial, tangential, axial."""
    radial = nodes[..., :2] / np.linalg.norm(nodes[..., :2], axis=-1, keepdims=True)
    frames = np.zeros((*nodes.shape[:2], 3, 3))
    frames[..., :2, 0] = radial
    frames[..., 0, 1], frames[..., 1, 1] = -radial[..., 1], radial[..., 0]
    frames[..., 2, 2] = 1.0
    return frames


# Elements whose lower face is half of a face of a twice as thick layer.


# Nodes of a face in the order of LOWER_FACE: position along the side 0-1, and across the layer.
ALONG = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0])
ACROSS = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 0.0, 0.0])
SIDE = [0, 1, 0, 1, 4, 4, 0, 1]
"""Node of the quadrilateral that each of them stands above."""


@dataclass(frozen=True)
class _CoarseFace:
    """The face that hanging nodes lie on."""

    nodes: FloatArray
    """Its nodes, m. Shape (m, 8, 3)."""
    weights: FloatArray
    """Value of each of its functions (column) at each hanging node (row). Shape (8, 8)."""

    def attach(self, nodes: FloatArray) -> FloatArray:
        """Return element nodes (m, 20, 3) with the hanging ones placed on this face."""
        attached = nodes.copy()
        attached[:, LOWER_FACE] = self.weights @ self.nodes
        return attached

    def transform(self, frames: FloatArray) -> FloatArray:
        """Return the Cartesian displacements (m, 60, 60) per freedom of the nodes that exist.

        `frames` (m, 20, 3, 3) are the axes of the nodes above; those of this face are cylindrical.
        """
        transform = np.zeros((len(frames), 20, 3, 20, 3))
        own = np.setdiff1d(np.arange(20), LOWER_FACE)
        transform[:, own, :, own] = frames[:, own].transpose(1, 0, 2, 3)
        moved = self.weights[:, None, :, None] * cylindrical_frames(self.nodes).transpose(0, 2, 1, 3)[:, None]
        hanging = np.array(LOWER_FACE)
        transform[:, hanging[:, None], :, hanging] = moved.transpose(1, 3, 0, 2, 4)
        return transform.reshape(len(frames), 60, 60)


def _coarse_face(section: FloatArray, thickness: float, turn: float, half: int) -> _CoarseFace:
    """Return the face that elements hang on, on its lower half (`half` -1) or its upper one (+1).

    `section` (m, 8, 2) are their section nodes at the middle of the thin layer, which turns by `turn` in
    rad, m.
    """
    nodes = above(section[:, SIDE], ACROSS - 0.5 * half, thickness, turn)
    return _CoarseFace(nodes, face_functions(ALONG, 0.5 * (ACROSS + half)))


def face_functions(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the eight-node serendipity functions at points (n,) of -1 .. 1, (n, 8)."""
    functions = []
    for a, b in zip(ALONG, ACROSS, strict=True):
        if a and b:
            functions.append(0.25 * (1 + a * x) * (1 + b * y) * (a * x + b * y - 1))
        elif a:
            functions.append(0.5 * (1 + a * x) * (1 - y * y))
        else:
            functions.append(0.5 * (1 - x * x) * (1 + b * y))
    return np.stack(functions, axis=-1)


# Stiffness of an elastic seat under the bore: a foundation in cylindrical components.


def _face_mass() -> FloatArray:
    """Return the products of the eight functions of a face integrated over -1 .. 1 squared, (8, 8)."""
    t, weight = np.polynomial.legendre.leggauss(3)
    x, y = (part.ravel() for part in np.meshgrid(t, t))
    functions = face_functions(x, y)
    return np.asarray(functions.T * np.outer(weight, weight).ravel() @ functions)


def _seat_stiffness(gear: Toothing, grid: SectorGrid, thickness: float, seat: BoreSeat) -> FloatArray:
    """Return the matrix (60, 60) of the seat below one element on the bore, N/m.

    Nodes on the bore are equally spaced in angle, so the radial, tangential and axial displacements are
    quadratic over a rectangle of the unrolled cylinder: a turn of the whole bore is met exactly, on
    helical meshes too. Only the finite stiffnesses count; freedoms in rigid directions are held.
    """
    area = gear.held_radius * 2.0 * math.pi / gear.teeth / grid.columns * thickness
    mass = 0.25 * area * _face_mass()
    matrix, nodes = np.zeros((20, 3, 20, 3)), np.array(LOWER_FACE)
    for c, stiffness in enumerate(seat.stiffness):
        if math.isfinite(stiffness):
            matrix[nodes[:, None], c, nodes, c] = stiffness * mass
    return matrix.reshape(60, 60)


@dataclass(frozen=True)
class ElementStiffness:
    """Stiffness of the elements of a sector."""

    matrices: FloatArray
    """N/m; freedoms in the order of `SweptSector.element_freedoms`. Shape (p, 60, 60)."""
    of_element: IntArray
    """Which of them each element has. Shape (e,)."""


def twist(gear: Toothing) -> float:
    """Return the turn of the section per axial length, rad/m, of the gear or its right-hand mirror image."""
    return abs(math.tan(gear.helix_angle)) / gear.reference_radius


def _flank_frames(section: QuadSector, turn_per_length: float) -> FloatArray:
    """Return the axes (k, 3, 3) at the flank nodes in cylindrical components, one per column.

    The first is the outward normal of the helicoid: with the transverse normal (n_r, n_phi),
    n_z = -n_phi r dphi/dz. The other two are tangents.
    """
    p, n = section.points[section.grid.flank], section.normals
    radius = np.linalg.norm(p, axis=1)
    radial = np.sum(n * p, axis=1) / radius
    around = (n[:, 1] * p[:, 0] - n[:, 0] * p[:, 1]) / radius
    normal = np.stack([radial, around, -around * radius * turn_per_length], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first = np.cross(normal, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([normal, first, np.cross(normal, first)], axis=-1)


def node_axes(gear: Toothing, section: QuadSector) -> FloatArray:
    """Return the axes (n, 3, 3) of the freedoms at all nodes of a section, in cylindrical components."""
    axes = np.tile(np.eye(3), (section.grid.nodes, 1, 1))
    axes[section.grid.flank] = _flank_frames(section, twist(gear))
    return axes


def sector_stiffness(gear: Toothing, section: QuadSector, sector: SweptSector) -> ElementStiffness:
    """Compute the matrices of all batches of a sector.

    `gear`: its material and helix matter.
    """
    axes, lame = node_axes(gear, section), PlaneHypothesis.PLANE_STRAIN.lame_parameters(gear.material)
    bodies = [batch for batch in sector.batches if not batch.seat]
    placed = [placed_layer(section, batch, axes, twist(gear)) for batch in bodies]
    solid = _stiffness_of(np.concatenate([nodes for nodes, _ in placed]), lame)
    ends = np.cumsum([len(batch.quads) for batch in bodies])
    matrices = [
        moved.transpose(0, 2, 1) @ local @ moved
        for local, (_, moved) in zip(np.split(solid, ends[:-1]), placed, strict=True)
    ]
    for batch in sector.batches[len(bodies) :]:
        seat = _seat_stiffness(gear, sector.grid, batch.thickness, sector.seat)
        matrices.append(np.tile(seat, (len(batch.quads), 1, 1)))
    of_element = np.empty(len(sector.elements), dtype=np.int64)
    first = 0
    for batch in sector.batches:
        of_element[batch.elements] = first + np.arange(len(batch.quads))
        first += len(batch.quads)
    return ElementStiffness(np.concatenate(matrices), of_element)


def placed_layer(
    section: QuadSector, batch: Batch, axes: FloatArray, turn_per_length: float
) -> tuple[FloatArray, FloatArray]:
    """Return nodes (m, 20, 3) of a batch and Cartesian displacements (m, 60, 60) per freedom."""
    quads, turn = section.grid.quads[batch.quads], batch.thickness * turn_per_length
    corners = section.points[quads]
    nodes = _layer_nodes(corners, batch.thickness, turn)
    frames = cylindrical_frames(nodes) @ axes[quads[:, SECTION]]
    if batch.half:
        face = _coarse_face(corners, batch.thickness, turn, batch.half)
        return face.attach(nodes), face.transform(frames)
    transform, every = np.zeros((len(nodes), 20, 3, 20, 3)), np.arange(20)
    transform[:, every, :, every] = frames.transpose(1, 0, 2, 3)
    return nodes, transform.reshape(len(nodes), 60, 60)
