"""Order of elimination of the nodes of a plane mesh: METIS' nested dissection of their graph."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fe_contact.types import IntArray


def mesh_graph(triangles: IntArray, count: int) -> sp.csr_array:
    """Return which of `count` nodes share six-node triangles (e, 6), a node with itself too."""
    rows = np.repeat(triangles, triangles.shape[1], axis=1).ravel()
    columns = np.tile(triangles, triangles.shape[1]).ravel()
    return sp.csr_array(sp.coo_array((np.ones(len(rows)), (rows, columns)), shape=(count, count)))


def dissected(graph: sp.csr_array, nodes: IntArray) -> IntArray:
    """Return nodes in an order that fills little."""
    import pymetis  # noqa: PLC0415 - only the factorisation needs it

    inner = sp.csr_array(graph[nodes][:, nodes])
    inner.setdiag(0.0)
    inner.eliminate_zeros()
    order, _ = pymetis.nested_dissection(pymetis.CSRAdjacency(inner.indptr, inner.indices))
    return np.asarray(nodes[np.asarray(order, dtype=np.int64)])
