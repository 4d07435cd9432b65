"""The equations of motion of a meshed housing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from bounds import inside
from dynamics.errors import InputError
from dynamics.housings.quadrature import over_surface, over_volume, tetrahedron
from dynamics.housings.reduced_housing import RigidBody, rigid_body, rigid_motions
from dynamics.housings.reduced_matrices import MeshedHousing
from dynamics.housings.supports import Foot, SeatBore, SeatFrame, in_axes, mean_motion, seat_frame, wall_nodes
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import Material, Ring
from dynamics.types import FloatArray, IntArray

# Freedoms of a mesh some of whose faces are rigid or fixed.


@dataclass(frozen=True)
class _RigidFace:
    """Nodes that move as one body about a point (m); `fixed` ones do not move."""

    name: str
    nodes: IntArray
    about: FloatArray
    fixed: bool = False


@dataclass(frozen=True)
class Freedoms:
    """Independent freedoms: three of each free node, then six of each rigid face.

    Attributes
    ----------
    motion : (3 n, f) sparse array
        Displacements of all nodes per freedom.
    free : int array
        The free nodes.
    faces : tuple of RigidFace
        Those that move. Six freedoms each: x, y, z, rotations about x, y, z through its point.
    """

    motion: sp.csr_array
    free: IntArray
    faces: tuple[_RigidFace, ...]

    def face(self, name: str) -> IntArray:
        """Return the six freedoms of a rigid face."""
        number = [face.name for face in self.faces].index(name)
        return 3 * len(self.free) + 6 * number + np.arange(6)

    def rigid(self, points: FloatArray, about: FloatArray) -> FloatArray:
        """Return the freedoms by rigid motions of all nodes, (f, 6), see `rigid_motions`."""
        parts = [rigid_motions(points[self.free], about)]
        for face in self.faces:
            turned = np.hstack([np.zeros((3, 3)), np.eye(3)])
            parts += [rigid_motions(face.about[None], about), turned]
        return np.vstack(parts)


def _independent_freedoms(points: FloatArray, faces: tuple[_RigidFace, ...]) -> Freedoms:
    """Eliminate the nodes of rigid faces.

    Raises
    ------
    InputError
        Two faces share nodes.
    """
    owner = np.full(len(points), -1)
    for number, face in enumerate(faces):
        shared = owner[face.nodes]
        if np.any(shared >= 0):
            bound = f'apart from "{faces[int(shared.max())].name}"'
            raise InputError(face.name, "rigid", bound, "They share nodes: move one, or make them one face.")
        owner[face.nodes] = number
    free = np.flatnonzero(owner < 0)
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    blocks = [(np.ones(rows.size), rows, np.arange(rows.size))]
    moving = tuple(face for face in faces if not face.fixed)
    for number, face in enumerate(moving):
        values = rigid_motions(points[face.nodes], face.about)
        at = (3 * face.nodes[:, None] + np.arange(3)).ravel()
        row, column = np.broadcast_arrays(at[:, None], rows.size + 6 * number + np.arange(6))
        blocks.append((values.ravel(), row.ravel(), column.ravel()))
    value, row, column = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    motion = sp.coo_array(
        (value, (row, column)), shape=(3 * len(points), rows.size + 6 * len(moving))
    ).tocsr()
    motion.eliminate_zeros()
    return Freedoms(motion, free, moving)


# Mass and stiffness matrices of quadratic tetrahedra.


BATCH = 2000
"""Elements at a time: bounds the memory of what is dense."""


def _mass_and_stiffness(mesh: TetrahedralMesh, material: Material) -> tuple[sp.csr_array, sp.csr_array]:
    """Return the consistent mass matrix per direction and the stiffness matrix.

    Parameters
    ----------
    mesh : TetrahedralMesh
    material : Material

    Returns
    -------
    mass : (n, n) sparse array
        kg, between nodes; it is the same for x, y and z.
    stiffness : (3 n, 3 n) sparse array
        N/m; freedom 3 i + k is the displacement of node i along axis k.
    """
    count = len(mesh.points)
    numbers = mesh.tetrahedra
    freedoms = np.reshape(3 * numbers[:, :, None] + np.arange(3), (len(numbers), 30))
    masses = np.empty((len(numbers), 10, 10))
    stiffnesses = np.empty((len(numbers), 30, 30))
    for first in range(0, len(numbers), BATCH):
        part = slice(first, first + BATCH)
        masses[part], stiffnesses[part] = _element_matrices(mesh.points, numbers[part], material)
    return _assembled(masses, numbers, count), _assembled(stiffnesses, freedoms, 3 * count)


def _element_matrices(
    points: FloatArray, tetrahedra: IntArray, material: Material
) -> tuple[FloatArray, FloatArray]:
    """Return the matrices of some elements: (e, 10, 10) and (e, 30, 30)."""
    volume, gradient = over_volume(points, tetrahedra)
    shape, (lame, shear) = tetrahedron().shape, material.lame
    mass = material.density * np.einsum("ap,bp,ep->eab", shape, shape, volume, optimize=True)
    flat = gradient.reshape(len(volume), 30, -1)
    # product[e, a, i, b, j]: integral of the slope of a along i times that of b along j
    product = ((flat * volume[:, None]) @ flat.transpose(0, 2, 1)).reshape(-1, 10, 3, 10, 3)
    stiffness = lame * product + shear * product.transpose(0, 1, 4, 3, 2)
    trace = shear * np.einsum("eakbk->eab", product)
    for axis in range(3):
        stiffness[:, :, axis, :, axis] += trace
    return mass, stiffness.reshape(-1, 30, 30)


def _assembled(matrices: FloatArray, freedoms: IntArray, size: int) -> sp.csr_array:
    short = freedoms.astype(np.int32)  # half the memory
    rows, columns = np.broadcast_arrays(short[:, :, None], short[:, None, :])
    entries = (matrices.ravel(), (rows.ravel(), columns.ravel()))
    return sp.coo_array(entries, shape=(size, size)).tocsr()


HELD = 1e-12
"""Stiffness against a rigid motion below which mounts do not hold it, relative to the stiffest."""


@dataclass(frozen=True)
class AssembledHousing:
    """M x'' + C x' + K x = B' f; q = B x.

    Attributes
    ----------
    freedoms : Freedoms
        x, f of them.
    mass, stiffness : (f, f) sparse arrays
        With the mounts' stiffness.
    mounts : tuple of two (f, f) sparse arrays
        Stiffness and damping of the mounts alone.
    seats : (s, f) sparse array
        B: motions q of the seats, one after the other.
    frames : tuple of SeatFrame
    loose : (f, k) array
        Rigid motions that feet and mounts do not hold; six without any.
    body : RigidBody
        Of the mesh.
    """

    freedoms: Freedoms
    mass: sp.csr_array
    stiffness: sp.csr_array
    mounts: tuple[sp.csr_array, sp.csr_array]
    seats: sp.csr_array
    frames: tuple[SeatFrame, ...]
    loose: FloatArray
    body: RigidBody


def assemble(housing: MeshedHousing) -> AssembledHousing:
    """Assemble a housing.

    Raises
    ------
    InputError
        A seat, foot or point is not on the mesh.
    """
    mesh = housing.mesh
    _check_faces(housing)
    frames = tuple(seat_frame(seat) for seat in housing.seats)
    freedoms = _independent_freedoms(mesh.points, _rigid_faces(housing))
    nodal_mass, stiffness = _mass_and_stiffness(mesh, housing.material)
    motion = freedoms.motion
    mass = sp.csr_array(sp.kron(nodal_mass, sp.eye_array(3), format="csr"))
    mounts = _stiffness_and_damping_of_mounts(housing.feet, freedoms)
    seats = [_motion(mesh, pair, freedoms) for pair in zip(housing.seats, frames, strict=True)]
    return AssembledHousing(
        freedoms,
        sp.csr_array(motion.T @ mass @ motion),
        sp.csr_array(motion.T @ stiffness @ motion + mounts[0]),
        mounts,
        sp.csr_array(sp.vstack(seats)),
        frames,
        _loose(mesh.points, housing.feet, freedoms, mounts[0]),
        rigid_body(mesh.points, nodal_mass),
    )


def _check_faces(housing: MeshedHousing) -> None:
    """Refuse a seat, a foot or a point that is not on the mesh, before anything costly."""
    for number, seat in enumerate(housing.seats):
        with inside(f"seats[{number}].bore"):
            seat.bore.triangles(housing.mesh)
    for number, foot in enumerate(housing.feet):
        with inside(f"feet[{number}].face"):
            foot.face.triangles(housing.mesh)
    housing.nodes_of_points()


def _rigid_faces(housing: MeshedHousing) -> tuple[_RigidFace, ...]:
    """Return rigid seats about their positions, then feet about the centroids of their faces."""
    mesh, faces = housing.mesh, []
    for seat in housing.seats:
        if seat.ring is Ring.RIGID:
            nodes = wall_nodes(mesh, seat.bore)
            faces.append(_RigidFace(f"seats.{seat.name}", nodes, np.array(seat.bore.position)))
    for foot in housing.feet:
        area, point = over_surface(mesh.points, foot.face.triangles(mesh))
        weight = np.linalg.norm(area, axis=2)
        centroid = np.einsum("tp,tpi->i", weight, point) / weight.sum()
        nodes = wall_nodes(mesh, foot.face)
        faces.append(_RigidFace(f"feet.{foot.name}", nodes, centroid, foot.mount is None))
    return tuple(faces)


def _motion(mesh: TetrahedralMesh, seat: tuple[SeatBore, SeatFrame], freedoms: Freedoms) -> sp.csr_array:
    """Return the motion of a seat along its own axes, (motions, f)."""
    bore, frame = seat
    if bore.ring is Ring.RIGID:
        whole = sp.csr_array(
            sp.eye_array(freedoms.motion.shape[1], format="csr")[freedoms.face(f"seats.{bore.name}")]
        )
    else:
        whole = mean_motion(mesh, bore.bore, frame.position) @ freedoms.motion
    return sp.csr_array(sp.csr_array(in_axes(frame)) @ whole)


def _stiffness_and_damping_of_mounts(
    feet: tuple[Foot, ...], freedoms: Freedoms
) -> tuple[sp.csr_array, sp.csr_array]:
    size = freedoms.motion.shape[1]
    both = [sp.csr_array((size, size)), sp.csr_array((size, size))]
    for foot in feet:
        if foot.mount is None:
            continue
        rows, columns = np.broadcast_arrays(*np.ix_(*2 * (freedoms.face(f"feet.{foot.name}"),)))
        for number, matrix in enumerate(foot.mount.matrices()):
            entries = (matrix.ravel(), (rows.ravel(), columns.ravel()))
            both[number] = sp.csr_array(both[number] + sp.coo_array(entries, shape=(size, size)))
    return both[0], both[1]


def _loose(
    points: FloatArray, feet: tuple[Foot, ...], freedoms: Freedoms, stiffness: sp.csr_array
) -> FloatArray:
    """Return the rigid motions without any stiffness against them, by freedom."""
    if any(foot.mount is None for foot in feet):
        return np.zeros((freedoms.motion.shape[1], 0))
    center = points.mean(axis=0)
    size = np.array(3 * [1.0] + 3 * [float(np.linalg.norm(points - center, axis=1).max())])
    rigid = freedoms.rigid(points, center) / size
    value, vector = np.linalg.eigh(rigid.T @ (stiffness @ rigid))
    return np.asarray(rigid @ vector[:, value <= HELD * max(value[-1], 1e-300)])
