"""The ring that copies of a condensed plane tooth sector close."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.condensed_sector import CondensedSector, freedoms
from fe_contact.compliance.factorization import Solve, factorise
from fe_contact.mesh.gear_mesh import GearMesh
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import sparse as sp


@dataclass(frozen=True)
class Ring:
    """Condensed stiffness of one gear, bore and cut planes clamped, per unit face width."""

    mesh: GearMesh
    """Mesh of the gear."""
    sector: CondensedSector
    """Condensed sector of one tooth."""
    hub_matrix: sp.csc_array | None
    """Stiffness of the hub on its own freedoms; None without a hub."""
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


def assemble_ring(mesh: GearMesh, sector: CondensedSector, hub_matrix: sp.csc_array | None) -> Ring:
    """Add up the condensed sectors and the hub, clamp the bore and cut planes, factorise."""
    retained = np.unique(np.concatenate([mesh.sector_nodes[:, sector.boundary].ravel(), mesh.hub_nodes]))
    retained = np.setdiff1d(retained, mesh.bore_nodes)
    position = np.full(2 * len(mesh.points), -1)
    position[freedoms(retained)] = np.arange(2 * len(retained))
    rows, columns, values = [], [], []
    for i in range(len(mesh.teeth)):
        turned = _turned_matrix(sector.stiffness, mesh.teeth[i] * mesh.pitch_angle)
        at = position[freedoms(mesh.sector_nodes[i, sector.boundary])]
        free = at >= 0
        rows.append(np.repeat(at[free], free.sum()))
        columns.append(np.tile(at[free], free.sum()))
        values.append(turned[np.ix_(free, free)].ravel())
    if hub_matrix is not None:
        coo = hub_matrix.tocoo()
        at = position[freedoms(mesh.hub_nodes)]
        free = (at[coo.row] >= 0) & (at[coo.col] >= 0)
        rows.append(at[coo.row[free]])
        columns.append(at[coo.col[free]])
        values.append(coo.data[free])
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    matrix = sp.csc_array(sp.coo_array(entries, shape=(2 * len(retained), 2 * len(retained))))
    return Ring(mesh, sector, hub_matrix, matrix, position, factorise(matrix, block=2))


def _turned_matrix(matrix: FloatArray, angle: float) -> FloatArray:
    """Return R K R' with R turning every node's vector."""
    r = rotation(angle)
    n = len(matrix) // 2
    return np.asarray(
        np.einsum("ab,ibjd,cd->iajc", r, matrix.reshape(n, 2, n, 2), r, optimize=True).reshape(2 * n, 2 * n)
    )


def flank_matrices(ring: Ring, teeth: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the displacements of flanks by loads on flanks, across and along them.

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
    motion = ring.solve(unit)[used] @ transmitted
    matrix = transmitted.T @ motion
    for n in range(count):
        matrix[n * k : (n + 1) * k, n * k : (n + 1) * k] += sector.flank
    middle = (count - 1) // 2
    boundary = motion[at[middle], middle * k : (middle + 1) * k]
    return np.asarray(matrix), sector.along + sector.along_boundary @ boundary
