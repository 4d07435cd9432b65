"""A plane tooth sector condensed to its flanks and cuts, and the ring that its copies close."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fe_contact.errors import SolveError
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray, IntArray

Solve = Callable[[FloatArray], FloatArray]
FACTORIZATION = "SuperLU on a METIS ordering"
"""Name of the method, for receipts and cache keys."""


def factorise(matrix: sp.csc_array, block: int) -> Solve:
    """Factorise a symmetric positive definite matrix once, for many right-hand sides.

    SciPy's SuperLU without pivoting, on METIS' nested dissection of the graph of the nodes, which hold
    `block` consecutive freedoms. Returns x(b) for b (n, m), dense. Raises `SolveError`: the matrix is
    singular.
    """
    order = _nested_dissection(matrix, block)
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"{FACTORIZATION}: {error}") from error

    def solve(right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[order] = factor.solve(right[order])
        return x

    return solve


def _nested_dissection(matrix: sp.csc_array, block: int) -> IntArray:
    """Return METIS' fill-reducing order of the freedoms, from the graph of their nodes."""
    import pymetis  # noqa: PLC0415 - a cached result needs no ordering

    graph = sp.csr_array(matrix[::block, ::block])
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    adjacency = pymetis.CSRAdjacency(graph.indptr, graph.indices)
    order, _ = pymetis.nested_dissection(adjacency)
    return (block * np.asarray(order, dtype=np.int64)[:, None] + np.arange(block)).ravel()


# Static condensation of one tooth sector onto the boundary it shares with the rest of the gear.


@dataclass(frozen=True)
class _CondensedSector:
    """One tooth sector seen from its boundary, in the tooth frame, per unit face width."""

    boundary: IntArray
    """Sector nodes on the boundary, clamped ones left out; freedom 2 i + c of the arrays below is component c
    of its node i. Shape (nb,).
    """
    stiffness: FloatArray
    """Condensed stiffness, Pa. Shape (2 nb, 2 nb)."""
    transmitted: FloatArray
    """Boundary force per unit flank force when the boundary is free to move. Shape (2 nb, k)."""
    flank: FloatArray
    """Inward flank displacement per unit flank force with the boundary held, 1/Pa. Shape (k, k)."""
    along: FloatArray
    along_boundary: FloatArray
    """`along`, `along_boundary`: Displacement of the flank's nodes along the flank towards the tip: per unit
    flank force with the boundary held, 1/Pa, and per displacement of the boundary. (k, k) and (k, 2 nb)
    arrays.
    """
    matrix: sp.csc_array
    """Uncondensed stiffness of the sector. (2n, 2n) sparse array."""
    loads: sp.csc_array
    """Unit inward normal forces at the flank nodes. (2n, k) sparse array."""
    interior: IntArray
    """Interior freedoms."""
    solve: Solve
    """K_ii^-1."""


def freedoms(nodes: IntArray) -> IntArray:
    """Return the two freedoms of each node, node by node."""
    return (2 * nodes[..., None] + np.arange(2)).reshape(*nodes.shape[:-1], -1)


def _inward_loads(size: int, nodes: IntArray, normals: FloatArray) -> sp.csc_array:
    """Return unit forces against the outward `normals` at `nodes`, (2 size, k)."""
    rows = freedoms(nodes)
    columns = np.repeat(np.arange(len(nodes)), 2)
    return sp.csc_array((-normals.ravel(), (rows, columns)), shape=(2 * size, len(nodes)))


def _along_flank(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Return the unit vectors (k, 2) along a flank towards its tip, which its last node is."""
    across = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    return np.asarray(across * np.sign(across.sum(axis=0) @ (points[-1] - points[0])))


def condense_sector(mesh: GearMesh, matrix: sp.csc_array, normals: FloatArray) -> _CondensedSector:
    """Condense the sector of `mesh`.

    Parameters
    ----------
    mesh : GearMesh
        Its sector and whether the sector's bottom is the clamped bore matter.
    matrix : (2n, 2n) sparse array
        Stiffness of the sector, N/m per m.
    normals : (k, 2) array
        Outward normals at the flank nodes in the tooth frame.
    """
    sector, size = mesh.sector, len(mesh.sector.points)
    shared = np.unique(np.concatenate([sector.right_side, sector.left_side, sector.bottom]))
    boundary = shared if mesh.hub is not None else np.setdiff1d(shared, sector.bottom)
    b, i = freedoms(boundary), freedoms(np.setdiff1d(np.arange(size), shared))
    loads = _inward_loads(size, sector.flank, normals)
    k_ib = matrix[i][:, b].toarray()
    n_i = loads[i].toarray()
    along = _along_flank(sector.points[sector.flank], normals)
    t_i = _inward_loads(size, sector.flank, -along)[i]
    solve = factorise(sp.csc_array(matrix[i][:, i]), block=2)
    solved = solve(np.concatenate([n_i, k_ib], axis=1))
    by_load, by_boundary = solved[:, : n_i.shape[1]], solved[:, n_i.shape[1] :]
    return _CondensedSector(
        boundary=boundary,
        stiffness=matrix[b][:, b].toarray() - k_ib.T @ by_boundary,
        transmitted=-k_ib.T @ by_load,
        flank=n_i.T @ by_load,
        along=t_i.T @ by_load,
        along_boundary=-(t_i.T @ by_boundary),
        matrix=matrix,
        loads=loads,
        interior=i,
        solve=solve,
    )


@dataclass(frozen=True)
class Ring:
    """Condensed stiffness of one gear, bore clamped, per unit face width."""

    mesh: GearMesh
    """Its mesh."""
    sector: _CondensedSector
    """One tooth."""
    hub_matrix: sp.csc_array | None
    """Stiffness of the hub on its own freedoms."""
    matrix: sp.csc_array
    """Condensed stiffness of the whole gear. (n, n) sparse array."""
    position: IntArray
    """Row in `matrix` of each freedom of the gear mesh, or -1. Shape (2 N,)."""
    solve: Solve
    """Inverse of `matrix`."""

    def rows(self, tooth_index: int) -> IntArray:
        """Return the rows of the boundary freedoms of one sector."""
        return self.position[freedoms(self.mesh.sector_nodes[tooth_index, self.sector.boundary])]

    def turned(self, tooth_index: int, values: FloatArray) -> FloatArray:
        """Turn boundary vectors (2 nb, m) from the tooth frame of one sector into that of the gear."""
        c_s = rotation(self.mesh.teeth[tooth_index] * self.mesh.pitch_angle)
        return np.asarray(
            np.einsum("cd,ndm->ncm", c_s, values.reshape(-1, 2, values.shape[1])).reshape(values.shape)
        )


def rotation(angle: float) -> FloatArray:
    """Return the matrix that turns vectors counter-clockwise by `angle`."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def assemble_ring(mesh: GearMesh, sector: _CondensedSector, hub_matrix: sp.csc_array | None) -> Ring:
    """Add up the condensed sectors and the hub, clamp the bore, factorise."""
    kept = np.unique(np.concatenate([mesh.sector_nodes[:, sector.boundary].ravel(), mesh.hub_nodes]))
    kept = np.setdiff1d(kept, mesh.bore_nodes)
    position = np.full(2 * len(mesh.points), -1)
    position[freedoms(kept)] = np.arange(2 * len(kept))
    rows, columns, values = [], [], []
    for i in range(len(mesh.teeth)):
        turned = _turned_matrix(sector.stiffness, mesh.teeth[i] * mesh.pitch_angle)
        at = position[freedoms(mesh.sector_nodes[i, sector.boundary])]
        rows.append(np.repeat(at, len(at)))
        columns.append(np.tile(at, len(at)))
        values.append(turned.ravel())
    if hub_matrix is not None:
        coo = hub_matrix.tocoo()
        at = position[freedoms(mesh.hub_nodes)]
        free = (at[coo.row] >= 0) & (at[coo.col] >= 0)
        rows.append(at[coo.row[free]])
        columns.append(at[coo.col[free]])
        values.append(coo.data[free])
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    matrix = sp.csc_array(sp.coo_array(entries, shape=(2 * len(kept), 2 * len(kept))))
    return Ring(mesh, sector, hub_matrix, matrix, position, factorise(matrix, block=2))


def _turned_matrix(matrix: FloatArray, angle: float) -> FloatArray:
    """Return R K R' with R turning every node's vector."""
    r = rotation(angle)
    n = len(matrix) // 2
    return np.asarray(
        np.einsum("ab,ibjd,cd->iajc", r, matrix.reshape(n, 2, n, 2), r, optimize=True).reshape(2 * n, 2 * n)
    )


def flank_matrices(ring: Ring, teeth: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return what loads on flanks move across and along them.

    Only rows that the loaded sectors touch are solved for.

    Parameters
    ----------
    teeth : (t,) int array
        Indices of the teeth; that in the middle is tooth 0.

    Returns
    -------
    matrix : (t k, t k) array
        The flank compliance of the teeth, 1/Pa; symmetric up to rounding.
    along : (k, k) array
        Displacement towards the tip at the nodes of a flank per inward force at its nodes, 1/Pa.
    """
    sector, k, count = ring.sector, ring.sector.flank.shape[0], len(teeth)
    blocks = [(ring.rows(i), ring.turned(i, sector.transmitted)) for i in teeth]
    used, inverse = np.unique(np.concatenate([rows for rows, _ in blocks]), return_inverse=True)
    transmitted, at = np.zeros((len(used), count * k)), np.split(inverse, count)
    for n, (_, block) in enumerate(blocks):
        transmitted[at[n], n * k : (n + 1) * k] = block
    unit = np.zeros((ring.matrix.shape[0], len(used)))
    unit[used, np.arange(len(used))] = 1.0
    moved = ring.solve(unit)[used] @ transmitted
    matrix = transmitted.T @ moved
    for n in range(count):
        matrix[n * k : (n + 1) * k, n * k : (n + 1) * k] += sector.flank
    middle = (count - 1) // 2
    boundary = moved[at[middle], middle * k : (middle + 1) * k]
    return np.asarray(matrix), sector.along + sector.along_boundary @ boundary
