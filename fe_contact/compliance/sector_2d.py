"""Static condensation of one tooth sector onto the boundary it shares with the rest of the gear.

All sectors of a gear are copies of one mesh, so its matrix is factorised once. With interior freedoms i,
boundary freedoms b and flank loads N (unit inward normal forces at the flank nodes, zero on b):

    K_ii u_i = N q - K_ib u_b,   (K_bb - K_bi K_ii^-1 K_ib) u_b = transmitted q + forces from outside,
    transmitted = -K_bi K_ii^-1 N,   N' u_i = (N' K_ii^-1 N) q + transmitted' u_b.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fe_contact.compliance.solvers import Solve, Solver
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class CondensedSector:
    """One tooth sector seen from its boundary, in the tooth frame, per unit face width.

    Attributes
    ----------
    boundary : (nb,) int array
        Sector nodes on the boundary, clamped ones left out; freedom 2 i + c of the arrays below is
        component c of its node i.
    stiffness : (2 nb, 2 nb) array
        Condensed stiffness, Pa.
    transmitted : (2 nb, k) array
        Boundary force per unit flank force when the boundary is free to move.
    flank : (k, k) array
        Inward flank displacement per unit flank force with the boundary held, 1/Pa.
    matrix : (2n, 2n) sparse array
        Uncondensed stiffness of the sector.
    loads : (2n, k) sparse array
        Unit inward normal forces at the flank nodes.
    interior : int array
        Interior freedoms.
    solve : callable
        K_ii^-1.
    """

    boundary: IntArray
    stiffness: FloatArray
    transmitted: FloatArray
    flank: FloatArray
    matrix: sp.csc_array
    loads: sp.csc_array
    interior: IntArray
    solve: Solve


def freedoms(nodes: IntArray) -> IntArray:
    """Return the two freedoms of each node, node by node."""
    return (2 * nodes[..., None] + np.arange(2)).reshape(*nodes.shape[:-1], -1)


def inward_loads(size: int, nodes: IntArray, normals: FloatArray) -> sp.csc_array:
    """Return unit forces against the outward `normals` at `nodes`, (2 size, k)."""
    rows = freedoms(nodes)
    columns = np.repeat(np.arange(len(nodes)), 2)
    return sp.csc_array((-normals.ravel(), (rows, columns)), shape=(2 * size, len(nodes)))


def condense_sector(
    mesh: GearMesh, matrix: sp.csc_array, normals: FloatArray, solver: Solver
) -> CondensedSector:
    """Condense the sector of `mesh`.

    Parameters
    ----------
    mesh : GearMesh
        Its sector and whether the sector's bottom is the clamped bore matter.
    matrix : (2n, 2n) sparse array
        Stiffness of the sector, N/m per m.
    normals : (k, 2) array
        Outward normals at the flank nodes in the tooth frame.
    solver : Solver
        Factorises K_ii.
    """
    sector, size = mesh.sector, len(mesh.sector.points)
    shared = np.unique(np.concatenate([sector.right_side, sector.left_side, sector.bottom]))
    boundary = shared if mesh.hub is not None else np.setdiff1d(shared, sector.bottom)
    b, i = freedoms(boundary), freedoms(np.setdiff1d(np.arange(size), shared))
    loads = inward_loads(size, sector.flank, normals)
    k_ib = matrix[i][:, b].toarray()
    n_i = loads[i].toarray()
    solve = solver.factorise(sp.csc_array(matrix[i][:, i]), block=2)
    solved = solve(np.concatenate([n_i, k_ib], axis=1))
    by_load, by_boundary = solved[:, : n_i.shape[1]], solved[:, n_i.shape[1] :]
    return CondensedSector(
        boundary=boundary,
        stiffness=matrix[b][:, b].toarray() - k_ib.T @ by_boundary,
        transmitted=-k_ib.T @ by_load,
        flank=n_i.T @ by_load,
        matrix=matrix,
        loads=loads,
        interior=i,
        solve=solve,
    )
