"""Checks of a condensed gear on its uncondensed mesh, by the field of one load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.flank import ComplianceChecks
from fe_contact.compliance.ring_2d import Ring, rotation
from fe_contact.compliance.rounding import left_by_rounding
from fe_contact.types import FloatArray
from host.optional_modules import linalg
from host.optional_modules import sparse as sp


@dataclass(frozen=True)
class Field:
    """Displacement of the whole mesh under a flank load on one tooth, per unit face width."""

    displacement: FloatArray
    """Displacement of the nodes, m per N/m of load. Shape (N, 2)."""
    load: FloatArray
    internal: FloatArray
    """`load`, `internal`: Applied nodal forces and K u, N/m. Shape (N, 2) each."""


@dataclass(frozen=True)
class _FlankLoad:
    """Inward normal forces on the involute of one tooth."""

    forces: FloatArray
    """Inward normal forces at the flank's nodes, N/m. Shape (k,)."""
    moment: float
    """Moment of the forces about the gear's axis, N. Every normal of an involute touches the base circle."""

    def work(self, matrix: FloatArray) -> float:
        """Return q' S q with S the middle diagonal block of a flank compliance."""
        k = len(self.forces)
        start = (len(matrix) // k - 1) // 2 * k
        return float(self.forces @ matrix[start : start + k, start : start + k] @ self.forces)


def uniform_pressure(s: FloatArray, s_form: float, base_radius: float) -> _FlankLoad:
    """Return the load of unit pressure on the involute.

    `s` (k,) are the flank's nodes; elements that begin below `s_form` carry nothing, since their normals
    miss the base circle.
    """
    lengths = np.where(s[:-2:2] >= s_form, s[2::2] - s[:-2:2], 0.0)
    forces = np.zeros(len(s))
    forces[:-2:2] += lengths / 6.0
    forces[1::2] = 4.0 * lengths / 6.0
    forces[2::2] += lengths / 6.0
    return _FlankLoad(forces, base_radius * float(forces.sum()))


def field_under(ring: Ring, tooth_index: int, forces: FloatArray) -> Field:
    """Solve for the whole mesh under inward normal `forces` (k,) on one tooth, and apply its stiffness."""
    mesh, sector = ring.mesh, ring.sector
    right = np.zeros((ring.matrix.shape[0], 1))
    right[ring.rows(tooth_index)] = ring.turned(tooth_index, (sector.transmitted @ forces)[:, None])
    free = ring.position >= 0
    shared = np.zeros(2 * len(mesh.points))
    shared[free] = ring.solve(right)[ring.position[free], 0]
    u = shared.reshape(-1, 2)
    local_load = np.zeros((sector.matrix.shape[0], len(mesh.teeth)))
    local_load[:, tooth_index] = sector.loads @ forces
    local = _recovered(ring, u, local_load)
    load, internal = np.zeros_like(u), np.zeros_like(u)
    forces_in = sector.matrix @ local
    for i, j in enumerate(mesh.teeth):
        rotation_matrix, nodes = rotation(j * mesh.pitch_angle).T, mesh.sector_nodes[i]
        u[nodes] = local[:, i].reshape(-1, 2) @ rotation_matrix
        internal[nodes] += forces_in[:, i].reshape(-1, 2) @ rotation_matrix
        load[nodes] += local_load[:, i].reshape(-1, 2) @ rotation_matrix
    if ring.hub_matrix is not None:
        internal[mesh.hub_nodes] += (ring.hub_matrix @ u[mesh.hub_nodes].ravel()).reshape(-1, 2)
    return Field(u, load, internal)


def _stiffness_alone(ring: Ring) -> FloatArray:
    """Return the stiffness (N,) in Pa of each node with all others held, along its stiffer axis."""
    mesh = ring.mesh
    stiffness, sector_entries = np.zeros(len(mesh.points)), _larger(ring.sector.matrix)
    for nodes in mesh.sector_nodes:
        stiffness[nodes] += sector_entries
    if ring.hub_matrix is not None:
        stiffness[mesh.hub_nodes] += _larger(ring.hub_matrix)
    return stiffness


def _larger(matrix: sp.csc_array) -> FloatArray:
    """Return the larger diagonal entry of each node, (n,)."""
    return np.asarray(matrix.diagonal().reshape(-1, 2).max(axis=1))


def _recovered(ring: Ring, u: FloatArray, load: FloatArray) -> FloatArray:
    """Return the displacement of every sector in its tooth frame (2n, t) from that of the shared nodes."""
    mesh, sector = ring.mesh, ring.sector
    local = np.zeros_like(load)
    for i, j in enumerate(mesh.teeth):
        local[:, i] = (u[mesh.sector_nodes[i]] @ rotation(j * mesh.pitch_angle)).ravel()
    local[sector.interior] = 0.0
    inner = sector.interior
    local[inner] = sector.solve((load - sector.matrix @ local)[inner])
    return local


def ring_checks(ring: Ring, tooth_index: int, load: _FlankLoad, matrix: FloatArray) -> ComplianceChecks:
    """Check the compliance of a ring under a load on the tooth of an index.

    `matrix` is the flank compliance as computed, before it is made symmetric; the loaded tooth is the
    middle one.
    """
    field = field_under(ring, tooth_index, load.forces)
    bore = ring.mesh.bore_nodes
    out_of_balance = field.load - field.internal
    reaction = -out_of_balance[bore]
    out_of_balance[bore] = 0.0
    x, y = ring.mesh.points[bore].T
    moment = float(np.sum(x * reaction[:, 1] - y * reaction[:, 0]))
    works = [float(np.sum(field.displacement * forces)) for forces in (field.internal, field.load)]
    works.append(load.work(matrix))
    stiffness = np.repeat(_stiffness_alone(ring), 2)
    unbalanced, energy = left_by_rounding(stiffness, field.displacement.ravel(), field.load, works[0])
    return ComplianceChecks(
        residual=float(np.linalg.norm(out_of_balance) / np.linalg.norm(field.load)),
        reciprocity=float(np.abs(matrix - matrix.T).max() / np.abs(matrix).max()),
        bore_moment=abs(moment + load.moment) / load.moment,
        energy=float(np.ptp(works) / works[0]),
        least_eigenvalue=float(linalg.eigh(matrix, subset_by_index=[0, 0], eigvals_only=True)[0]),
        residual_rounding=unbalanced,
        energy_rounding=energy,
    )
