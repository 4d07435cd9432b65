"""One gear condensed to the nodes of its strips: one factorization, the strips' freedoms last."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import SuperLU, splu

from fe_contact.errors import SolveError
from fe_contact.material import Material
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.placed_mesh import PlacedBody
from verification.full_contact.condensation.plane_strain_stiffness import plane_strain_stiffness


def mesh_graph(triangles: IntArray, count: int) -> sp.csr_array:
    """Return which of `count` nodes share six-node triangles (e, 6), a node with itself too."""
    rows = np.repeat(triangles, triangles.shape[1], axis=1).ravel()
    columns = np.tile(triangles, triangles.shape[1]).ravel()
    return sp.csr_array(sp.coo_array((np.ones(len(rows)), (rows, columns)), shape=(count, count)))


def dissected(graph: sp.csr_array, nodes: IntArray) -> IntArray:
    """Return nodes in an order that fills little: METIS' nested dissection of their graph."""
    import pymetis  # noqa: PLC0415 - only the factorisation needs it

    inner = sp.csr_array(graph[nodes][:, nodes])
    inner.setdiag(0.0)
    inner.eliminate_zeros()
    order, _ = pymetis.nested_dissection(pymetis.CSRAdjacency(inner.indptr, inner.indices))
    return np.asarray(nodes[np.asarray(order, dtype=np.int64)])


@dataclass(frozen=True)
class CondensedBody:
    """One gear condensed to the nodes of its strips, per unit face width."""

    body: PlacedBody
    nodes: IntArray
    """Numbers of all nodes of the strips. Shape (k,)."""
    columns: Mapping[int, IntArray]
    """Positions in `nodes` of the nodes of each strip, by pair index."""
    compliance: FloatArray
    """Displacement per nodal force, m per N/m; freedom 2 i + c is component c of node i. Shape (2 k, 2 k)."""
    stiffness: sp.csc_array
    """Stiffness of all nodes, held ones included. (2 n, 2 n) sparse array."""
    solve: Callable[[FloatArray], FloatArray]
    """Function from forces on the freedoms of all nodes (2 n,) to displacements; held nodes stay."""

    @property
    def freedoms(self) -> IntArray:
        """Freedoms of the nodes of the strips."""
        return freedoms(self.nodes)

    @property
    def points(self) -> FloatArray:
        """Undeformed nodes of the strips, (k, 2) m."""
        return self.body.points[self.nodes]


def condensed_body(body: PlacedBody, material: Material) -> CondensedBody:
    """Assemble, factorise, condense; raises `SolveError`: the stiffness is singular."""
    matrix = plane_strain_stiffness(body.points, body.triangles, material)
    nodes = np.unique(np.concatenate([strip.nodes for strip in body.strips.values()]))
    columns = {ahead: np.searchsorted(nodes, strip.nodes) for ahead, strip in body.strips.items()}
    inner = np.setdiff1d(np.arange(len(body.points)), np.concatenate([nodes, body.bore_nodes]))
    inner = dissected(mesh_graph(body.triangles, len(body.points)), inner)
    order = np.concatenate([freedoms(inner), freedoms(nodes)])
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"full contact: {error}") from error

    def solve(forces: FloatArray) -> FloatArray:
        displacement = np.zeros_like(forces)
        displacement[order] = factor.solve(forces[order])
        return displacement

    schur = _trailing_product(factor, 2 * len(nodes))
    compliance = cho_solve(cho_factor(schur), np.eye(len(schur)))
    return CondensedBody(body, nodes, columns, 0.5 * (compliance + compliance.T), matrix, solve)


def freedoms(nodes: IntArray) -> IntArray:
    """Return the two freedoms of each node, node by node."""
    return np.asarray((2 * nodes[:, None] + np.arange(2)).ravel())


def _trailing_product(factor: SuperLU, count: int) -> FloatArray:
    """Return L_ss U_ss of the last `count` freedoms: their Schur complement, symmetric."""
    size = factor.shape[0]
    last = np.arange(size - count, size)
    if not (np.array_equal(factor.perm_c[last], last) and np.array_equal(factor.perm_r[last], last)):
        raise SolveError("full contact: the factorisation changed the order of the strips")
    lower = factor.L[size - count :, size - count :].toarray()
    upper = factor.U[size - count :, size - count :].toarray()
    product = lower @ upper
    return np.asarray(0.5 * (product + product.T))
