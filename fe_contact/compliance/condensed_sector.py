"""Static condensation of one tooth sector onto the boundary it shares with the rest of the gear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.factorization import Solve, factorise
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import sparse as sp


@dataclass(frozen=True)
class CondensedSector:
    """One tooth sector seen from its boundary, in the tooth frame, per unit face width."""

    boundary: IntArray
    """Sector nodes on the boundary without clamped nodes; freedom 2 i + c of the arrays below is component c
    of node i of this array. Shape (nb,).
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


def inward_loads(size: int, nodes: IntArray, normals: FloatArray) -> sp.csc_array:
    """Return unit forces against the outward `normals` at `nodes`, (2 size, k)."""
    rows = freedoms(nodes)
    columns = np.repeat(np.arange(len(nodes)), 2)
    return sp.csc_array((-normals.ravel(), (rows, columns)), shape=(2 * size, len(nodes)))


def _along_flank(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Return the unit vectors (k, 2) along a flank towards its tip, which its last node is."""
    across = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    return np.asarray(across * np.sign(across.sum(axis=0) @ (points[-1] - points[0])))


def condense_sector(mesh: GearMesh, matrix: sp.csc_array, normals: FloatArray) -> CondensedSector:
    """Condense the sector of `mesh`.

    Parameters
    ----------
    mesh : GearMesh
        Mesh of a gear. Its sector is condensed; without a hub the bottom of the sector is the clamped bore.
    matrix : (2n, 2n) sparse array
        Stiffness of the sector, N/m per m.
    normals : (k, 2) array
        Outward normals at the flank nodes in the tooth frame.
    """
    sector, size = mesh.sector, len(mesh.sector.points)
    shared = np.unique(np.concatenate([sector.right_side, sector.left_side, sector.bottom]))
    boundary = shared if mesh.hub is not None else np.setdiff1d(shared, sector.bottom)
    b, i = freedoms(boundary), freedoms(np.setdiff1d(np.arange(size), shared))
    loads = inward_loads(size, sector.flank, normals)
    k_ib = matrix[i][:, b].toarray()
    n_i = loads[i].toarray()
    along = _along_flank(sector.points[sector.flank], normals)
    t_i = inward_loads(size, sector.flank, -along)[i]
    solve = factorise(sp.csc_array(matrix[i][:, i]), block=2)
    solved = solve(np.concatenate([n_i, k_ib], axis=1))
    by_load, by_boundary = solved[:, : n_i.shape[1]], solved[:, n_i.shape[1] :]
    return CondensedSector(
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
