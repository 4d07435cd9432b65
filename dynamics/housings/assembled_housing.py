"""The equations of motion of a meshed housing, some of whose faces are rigid or fixed.

Sizes: n nodes of the mesh, f independent freedoms, s motions of all seats.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import inside
from dynamics.errors import InputError
from dynamics.housings.meshed_housing import MeshedHousing
from dynamics.housings.quadrature import over_surface, over_volume
from dynamics.housings.rigid_body import RigidBody, rigid_body, rigid_motions
from dynamics.housings.supports import Foot, SeatBore, SeatFrame, in_axes, mean_motion
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import Material, Ring
from dynamics.types import FloatArray, IntArray
from host.optional_modules import sparse as sp

LOOSE_STIFFNESS = 1e-12
"""Stiffness against a rigid motion below which mounts leave it free, relative to the stiffest motion."""
BLOCK = 3
"""Consecutive freedoms that a solver may permute as one block: the three of a node, or three of the six of a
rigid face."""


@dataclass(frozen=True)
class _RigidFace:
    """Nodes that move as one rigid body."""

    name: str
    nodes: IntArray
    """Indices of the nodes of the mesh."""
    about: FloatArray
    """Point about which the body rotates, m. Shape (3,)."""
    fixed: bool = False
    """Whether the nodes do not move at all."""


@dataclass(frozen=True)
class _Freedoms:
    """Independent freedoms: three of each free node, then six of each rigid face."""

    motion: sp.csr_array
    """Displacements of all nodes per freedom, node by node. (3 n, f) sparse array."""
    free: IntArray
    """The free nodes."""
    faces: tuple[_RigidFace, ...]
    """Rigid faces that move. Each has six freedoms: x, y, z, rotations about x, y, z through its point."""

    def face(self, name: str) -> IntArray:
        """Return the six freedoms of a rigid face."""
        number = [face.name for face in self.faces].index(name)
        return 3 * len(self.free) + 6 * number + np.arange(6)

    def rigid(self, points: FloatArray, about: FloatArray) -> FloatArray:
        """Return the freedoms (f, 6) in each of the six rigid motions of the housing about `about`."""
        parts = [rigid_motions(points[self.free], about)]
        for face in self.faces:
            rotations = np.hstack([np.zeros((3, 3)), np.eye(3)])  # a rigid face rotates with the housing
            parts += [rigid_motions(face.about[None], about), rotations]
        return np.vstack(parts)


def _independent_freedoms(points: FloatArray, faces: tuple[_RigidFace, ...]) -> _Freedoms:
    """Eliminate the nodes of rigid faces; raises `InputError`: two faces share nodes."""
    owner = np.full(len(points), -1)
    for number, face in enumerate(faces):
        shared = owner[face.nodes]
        if np.any(shared >= 0):
            bound = f'without nodes of "{faces[int(shared.max())].name}"'
            raise InputError(face.name, "rigid", bound, "They share nodes: move one, or make them one face.")
        owner[face.nodes] = number
    free = np.flatnonzero(owner < 0)
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    blocks = [(np.ones(rows.size), rows, np.arange(rows.size))]  # entries: value, row, column
    moving = tuple(face for face in faces if not face.fixed)
    for number, face in enumerate(moving):
        values = rigid_motions(points[face.nodes], face.about)
        face_rows = (3 * face.nodes[:, None] + np.arange(3)).ravel()
        row, column = np.broadcast_arrays(face_rows[:, None], rows.size + 6 * number + np.arange(6))
        blocks.append((values.ravel(), row.ravel(), column.ravel()))
    value, row, column = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    motion = sp.coo_array(
        (value, (row, column)), shape=(3 * len(points), rows.size + 6 * len(moving))
    ).tocsr()
    motion.eliminate_zeros()
    return _Freedoms(motion, free, moving)


def mass_and_stiffness(mesh: TetrahedralMesh, material: Material) -> tuple[sp.csr_array, sp.csr_array]:
    """Return the consistent mass matrix per direction and the stiffness matrix.

    Returns
    -------
    mass : (n, n) sparse array
        kg, between nodes; it is the same for x, y and z.
    stiffness : (3 n, 3 n) sparse array
        N/m; freedom 3 i + k is the displacement of node i along axis k.
    """
    shapes, slopes = over_volume(mesh.points, mesh.tetrahedra)
    lame, shear = material.lame
    # slopes[3 i + j]: integral of the slope of shape a along i times that of b along j, (n, n)
    blocks = [[lame * slopes[3 * i + j] + shear * slopes[3 * j + i] for j in range(3)] for i in range(3)]
    for i in range(3):
        blocks[i][i] += shear * (slopes[0] + slopes[4] + slopes[8])
    by_node = np.arange(3 * len(mesh.points)).reshape(3, -1).T.ravel()  # from direction by direction
    stiffness = sp.block_array(blocks, format="csr")[by_node][:, by_node]
    return material.density * shapes, stiffness


@dataclass(frozen=True)
class AssembledHousing:
    """The equations M x'' + C x' + K x = B' p of a housing under forces p on its seats; q = B x.

    The damping C is that of the mounts.
    """

    freedoms: _Freedoms
    """The f freedoms x."""
    mass: sp.csr_array
    stiffness: sp.csr_array
    """`mass`, `stiffness`: Matrices M and K, the mounts' stiffness included. (f, f) sparse arrays."""
    mounts: tuple[sp.csr_array, sp.csr_array]
    """Stiffness and damping of the mounts alone. Tuple of two (f, f) sparse arrays."""
    seats: sp.csr_array
    """B: motions q of the seats per freedom, seat by seat. (s, f) sparse array."""
    frames: tuple[SeatFrame, ...]
    loose: FloatArray
    """The k rigid motions that feet and mounts leave free, by freedom; 6 without any foot. Shape (f, k)."""
    body: RigidBody
    """Mass, center and inertia of the mesh as a rigid body."""


def assemble(housing: MeshedHousing) -> AssembledHousing:
    """Assemble a housing; raises `InputError`: a seat, foot or point is not on the mesh."""
    mesh = housing.mesh
    _check_faces(housing)
    frames = tuple(seat.frame for seat in housing.seats)
    freedoms = _independent_freedoms(mesh.points, _rigid_faces(housing))
    nodal_mass, stiffness = mass_and_stiffness(mesh, housing.material)
    motion = freedoms.motion
    mass = sp.csr_array(sp.kron(nodal_mass, sp.eye_array(3), format="csr"))
    mounts = _stiffness_and_damping_of_mounts(housing.feet, freedoms)
    seats = [_motion(mesh, pair, freedoms) for pair in zip(housing.seats, frames, strict=True)]
    return AssembledHousing(
        freedoms=freedoms,
        mass=sp.csr_array(motion.T @ mass @ motion),
        stiffness=sp.csr_array(motion.T @ stiffness @ motion + mounts[0]),
        mounts=mounts,
        seats=sp.csr_array(sp.vstack(seats)),
        frames=frames,
        loose=_loose(mesh.points, housing.feet, freedoms, mounts[0]),
        body=rigid_body(mesh.points, nodal_mass),
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
            nodes = seat.bore.nodes(mesh)
            faces.append(_RigidFace(f"seats.{seat.name}", nodes, np.array(seat.bore.position)))
    for foot in housing.feet:
        triangles = foot.face.triangles(mesh)
        area, point = over_surface(mesh.points, triangles)
        weight = np.linalg.norm(area, axis=2)
        centroid = np.einsum("tp,tpi->i", weight, point) / weight.sum()
        faces.append(_RigidFace(f"feet.{foot.name}", np.unique(triangles), centroid, foot.mount is None))
    return tuple(faces)


def _motion(mesh: TetrahedralMesh, seat: tuple[SeatBore, SeatFrame], freedoms: _Freedoms) -> sp.csr_array:
    """Return the motion of a seat along its own axes, (motions, f)."""
    bore, frame = seat
    if bore.ring is Ring.RIGID:
        seat_motion = sp.csr_array(
            sp.eye_array(freedoms.motion.shape[1], format="csr")[freedoms.face(f"seats.{bore.name}")]
        )
    else:
        seat_motion = mean_motion(mesh, bore.bore, frame.position) @ freedoms.motion
    return sp.csr_array(sp.csr_array(in_axes(frame)) @ seat_motion)


def _stiffness_and_damping_of_mounts(
    feet: tuple[Foot, ...], freedoms: _Freedoms
) -> tuple[sp.csr_array, sp.csr_array]:
    """Return stiffness and damping of all mounts, (f, f) each."""
    size = freedoms.motion.shape[1]
    both = [sp.csr_array((size, size)), sp.csr_array((size, size))]
    for foot in feet:
        if foot.mount is None:
            continue
        foot_freedoms = freedoms.face(f"feet.{foot.name}")
        rows, columns = np.broadcast_arrays(*np.ix_(foot_freedoms, foot_freedoms))
        for number, matrix in enumerate(foot.mount.matrices()):
            entries = (matrix.ravel(), (rows.ravel(), columns.ravel()))
            both[number] = sp.csr_array(both[number] + sp.coo_array(entries, shape=(size, size)))
    return both[0], both[1]


def _loose(
    points: FloatArray, feet: tuple[Foot, ...], freedoms: _Freedoms, stiffness: sp.csr_array
) -> FloatArray:
    """Return the rigid motions that no mount resists, by freedom, (f, k)."""
    if any(foot.mount is None for foot in feet):
        return np.zeros((freedoms.motion.shape[1], 0))
    center = points.mean(axis=0)
    # rotations times the size of the housing, so that stiffnesses against all six motions are N/m
    size = np.array(3 * [1.0] + 3 * [float(np.linalg.norm(points - center, axis=1).max())])
    rigid = freedoms.rigid(points, center) / size
    value, vector = np.linalg.eigh(rigid.T @ (stiffness @ rigid))
    # 1e-300: without any mount all six stiffnesses are 0
    return np.asarray(rigid @ vector[:, value <= LOOSE_STIFFNESS * max(value[-1], 1e-300)])
