"""The equations of motion of a meshed housing, its free modes, its deflections under forces on its seats."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import scipy.sparse as sp

from bounds import inside
from dynamics.errors import InputError, SolveError
from dynamics.housings.quadrature import over_surface, over_volume
from dynamics.housings.reduced_housing import RigidBody, rigid_body, rigid_motions
from dynamics.housings.reduced_matrices import MeshedHousing
from dynamics.housings.supports import Foot, SeatBore, SeatFrame, in_axes, mean_motion
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import Material, Ring
from dynamics.types import FloatArray, IntArray

# Freedoms of a mesh some of whose faces are rigid or fixed.

HELD = 1e-12
"""Stiffness against a rigid motion below which mounts do not hold it, relative to the stiffest."""
BLOCK = 3
"""Consecutive freedoms that are ordered as one: those of a node, half those of a rigid face."""
Solve = Callable[[FloatArray], FloatArray]
SHIFT = 1e-10
"""Shift of a housing that may move freely, relative to a bound of the highest squared frequency."""
REFINEMENTS = 8
REFINED, ACCEPTED = 1e-12, 1e-6
"""Work of the forces that a deflection leaves unbalanced, relative to that of its load: where refining ends,
and the most that is accepted. Soft mounts and slender bodies are ill conditioned and stay between."""


@dataclass(frozen=True)
class _RigidFace:
    """Nodes that move as one body about a point (m); `fixed` ones do not move."""

    name: str
    nodes: IntArray
    about: FloatArray
    fixed: bool = False


@dataclass(frozen=True)
class _Freedoms:
    """Independent freedoms: three of each free node, then six of each rigid face."""

    motion: sp.csr_array
    """Displacements of all nodes per freedom. (3 n, f) sparse array."""
    free: IntArray
    """The free nodes."""
    faces: tuple[_RigidFace, ...]
    """Those that move. Six freedoms each: x, y, z, rotations about x, y, z through its point."""

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


def _independent_freedoms(points: FloatArray, faces: tuple[_RigidFace, ...]) -> _Freedoms:
    """Eliminate the nodes of rigid faces; raises `InputError`: two faces share nodes."""
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
    return _Freedoms(motion, free, moving)


# Mass and stiffness matrices of quadratic tetrahedra.


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
    blocks = [[lame * slopes[3 * i + j] + shear * slopes[3 * j + i] for j in range(3)] for i in range(3)]
    for i in range(3):
        blocks[i][i] += shear * (slopes[0] + slopes[4] + slopes[8])
    by_node = np.arange(3 * len(mesh.points)).reshape(3, -1).T.ravel()
    stiffness = sp.block_array(blocks, format="csr")[by_node][:, by_node]
    return material.density * shapes, stiffness


@dataclass(frozen=True)
class AssembledHousing:
    """M x'' + C x' + K x = B' f; q = B x."""

    freedoms: _Freedoms
    """x, f of them."""
    mass: sp.csr_array
    stiffness: sp.csr_array
    """`mass`, `stiffness`: With the mounts' stiffness. (f, f) sparse arrays."""
    mounts: tuple[sp.csr_array, sp.csr_array]
    """Stiffness and damping of the mounts alone. Tuple of two (f, f) sparse arrays."""
    seats: sp.csr_array
    """B: motions q of the seats, one after the other. (s, f) sparse array."""
    frames: tuple[SeatFrame, ...]
    loose: FloatArray
    """Rigid motions that feet and mounts do not hold; six without any. Shape (f, k)."""
    body: RigidBody
    """Of the mesh."""


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
            nodes = np.unique(seat.bore.triangles(mesh))
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
        whole = sp.csr_array(
            sp.eye_array(freedoms.motion.shape[1], format="csr")[freedoms.face(f"seats.{bore.name}")]
        )
    else:
        whole = mean_motion(mesh, bore.bore, frame.position) @ freedoms.motion
    return sp.csr_array(sp.csr_array(in_axes(frame)) @ whole)


def _stiffness_and_damping_of_mounts(
    feet: tuple[Foot, ...], freedoms: _Freedoms
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
    points: FloatArray, feet: tuple[Foot, ...], freedoms: _Freedoms, stiffness: sp.csr_array
) -> FloatArray:
    """Return the rigid motions without any stiffness against them, by freedom."""
    if any(foot.mount is None for foot in feet):
        return np.zeros((freedoms.motion.shape[1], 0))
    center = points.mean(axis=0)
    size = np.array(3 * [1.0] + 3 * [float(np.linalg.norm(points - center, axis=1).max())])
    rigid = freedoms.rigid(points, center) / size
    value, vector = np.linalg.eigh(rigid.T @ (stiffness @ rigid))
    return np.asarray(rigid @ vector[:, value <= HELD * max(value[-1], 1e-300)])


# Natural modes with the seats free, and static deflection under forces on them.


# Factor of a symmetric positive definite matrix: SuperLU without pivoting on an ordering by METIS.


def _factorized(matrix: sp.csr_array) -> Solve:
    """Return x of matrix x = b; b is (f,) or (f, m); refuses a singular matrix."""
    from scipy.sparse.linalg import splu  # noqa: PLC0415 (start-up time)

    order = _nested_dissection(matrix)
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"The stiffness matrix of the housing cannot be factorized: {error}.") from error

    def solve(right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[order] = factor.solve(right[order])
        return x

    return solve


def _nested_dissection(matrix: sp.csr_array) -> IntArray:
    """Return METIS' fill-reducing order, from the graph of blocks."""
    import pymetis  # noqa: PLC0415 (start-up time)

    blocks = matrix.tobsr(blocksize=(BLOCK, BLOCK))
    graph = sp.csr_array((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    order, _ = pymetis.nested_dissection(pymetis.CSRAdjacency(graph.indptr, graph.indices))
    return (BLOCK * np.asarray(order, dtype=np.int64)[:, None] + np.arange(BLOCK)).ravel()


class ModeStatus(IntEnum):
    """The end of the search for modes and deflections."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # fewer modes than requested; those found are exact
    ILL_CONDITIONED = 2  # deflections under forces on the seats miss their residual


@dataclass(frozen=True)
class FreeModes:
    """Modes, unit modal mass, and static deflections."""

    rigid: FloatArray
    """Rigid motions that nothing holds. Shape (f, k)."""
    shape: FloatArray
    """Shape (f, m)."""
    frequency: FloatArray
    """Hz, rising; of elastic modes alone. Shape (m,)."""
    deflection: FloatArray
    """Under unit forces on the seats; where the housing is loose, in balance with its inertia. Shape (f, s).
    """
    status: ModeStatus
    eigen_residual: float
    """Largest |K x - w^2 M x| / |K x|."""
    solve_residual: float
    """Largest work of the unbalanced forces on a deflection, relative to that of its load."""
    rigid_ratio: float
    """Highest frequency found for a rigid motion over that of the first elastic mode; 0 where held."""


def free_modes(housing: AssembledHousing, count: int) -> FreeModes:
    """Find the lowest elastic modes by shift-invert Lanczos, and the deflections by the same factor.

    What did not converge is in the status. Raises `SolveError`: the stiffness is singular.
    """
    loose = housing.loose.shape[1]
    squares = housing.stiffness.diagonal() / housing.mass.diagonal() if loose else np.zeros(1)
    shift = SHIFT * float(np.max(squares))
    shifted = sp.csr_array(housing.stiffness + shift * housing.mass) if loose else housing.stiffness
    solve = _factorized(shifted)
    held = housing.loose
    factor = np.linalg.cholesky(held.T @ (housing.mass @ held))
    rigid: FloatArray = np.asarray(np.linalg.solve(factor, held.T).T)  # orthonormal
    square, shape = _lanczos(housing, solve, shift, count + loose)
    deflection, residual = _deflections(housing, solve, rigid)
    elastic, own = shape[:, loose:], square[loose:]
    force = housing.stiffness @ elastic
    missed = np.linalg.norm(force - (housing.mass @ elastic) * own, axis=0)
    status = ModeStatus.CONVERGED if residual <= ACCEPTED else ModeStatus.ILL_CONDITIONED
    if own.size != count:
        status = ModeStatus.ITERATION_LIMIT
    return FreeModes(
        rigid=rigid,
        shape=elastic,
        frequency=np.sqrt(np.maximum(own, 0.0)) / (2.0 * math.pi),
        deflection=deflection,
        status=status,
        eigen_residual=float(np.max(missed / np.linalg.norm(force, axis=0), initial=0.0)),
        solve_residual=residual,
        rigid_ratio=math.sqrt(float(np.abs(square[:loose]).max()) / own[0]) if loose and own.size else 0.0,
    )


def _lanczos(
    housing: AssembledHousing, solve: Solve, shift: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return squared circular frequencies, rising, and their modes: those that converged."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh  # noqa: PLC0415

    size = housing.stiffness.shape[0]
    inverse = LinearOperator((size, size), matvec=solve, dtype=float)
    start = np.cos(np.arange(size, dtype=float))  # the same in every run
    basis = min(size - 1, basis_vectors(count))
    try:
        square, shape = eigsh(
            housing.stiffness, count, housing.mass, sigma=-shift, OPinv=inverse, v0=start, ncv=basis
        )
    except ArpackNoConvergence as error:
        square, shape = error.eigenvalues, error.eigenvectors
    order = np.argsort(square)
    return square[order], shape[:, order]


def basis_vectors(count: int) -> int:
    """Return how many vectors Lanczos' method holds for so many modes."""
    return count + max(count // 2, 20)


def _deflections(housing: AssembledHousing, solve: Solve, rigid: FloatArray) -> tuple[FloatArray, float]:
    """Return deflections and their residual.

    A loose housing is accelerated by the loads: inertia balances them, and the shift of the factor is
    taken out by iterative refinement.
    """
    inertia = housing.mass @ rigid
    load = housing.seats.T.toarray()
    load -= inertia @ (rigid.T @ load)
    deflection, missed = np.zeros_like(load), load
    residual = math.inf
    for _ in range(REFINEMENTS):
        deflection = deflection + solve(missed)
        deflection -= rigid @ (inertia.T @ deflection)
        missed = load - housing.stiffness @ deflection
        lost, done = (np.einsum("fs,fs->s", deflection, force) for force in (missed, load))
        previous, residual = residual, float(np.max(np.abs(lost) / done))
        if residual <= REFINED or residual > 0.5 * previous:
            break
    return deflection, residual
