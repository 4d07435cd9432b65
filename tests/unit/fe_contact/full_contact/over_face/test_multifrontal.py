"""Dissected elimination of columns on a plane graph: the Schur complement of dense algebra."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from fe_contact.errors import SolveError
from fe_contact.full_contact.condensation.contact_model import dissected
from fe_contact.full_contact.over_face.extruded_body import _ColumnMatrix, _schur_complement
from fe_contact.types import FloatArray

SIDE, KEPT = 9, 7


def columns(shift: float = 0.0) -> tuple[_ColumnMatrix, FloatArray]:
    """A grid of nodes with 1 to 4 unknowns each, its last nodes kept; the matrix dense too."""
    rng = np.random.default_rng(2)
    nodes = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    pairs = [(nodes[:-1], nodes[1:]), (nodes[:, :-1], nodes[:, 1:]), (nodes[:-1, :-1], nodes[1:, 1:])]
    rows, others = (np.concatenate([pair[k].ravel() for pair in pairs]) for k in range(2))
    graph = sp.coo_array((np.ones(len(rows)), (rows, others)), shape=(SIDE**2, SIDE**2))
    graph = sp.csr_array(graph + graph.T + sp.eye_array(SIDE**2))
    order = np.concatenate([dissected(graph, np.arange(SIDE**2 - KEPT)), nodes.ravel()[-KEPT:]])
    graph = sp.csr_array(graph[order][:, order])
    counts = rng.integers(1, 5, SIDE**2)
    starts = np.concatenate([[0], np.cumsum(counts)])
    owner = np.repeat(np.arange(SIDE**2), counts)
    dense = rng.normal(size=(starts[-1], starts[-1])) * (graph.toarray()[np.ix_(owner, owner)] > 0.0)
    dense = dense + dense.T
    dense += (np.abs(dense).sum(axis=1).max() - shift) * np.eye(len(dense))
    return _ColumnMatrix(sp.csc_array(np.tril(dense)), starts, graph), dense


def test_it_is_that_of_dense_algebra() -> None:
    matrix, dense = columns()
    first = matrix.starts[-1 - KEPT]
    inner, across, outer = dense[:first, :first], dense[:first, first:], dense[first:, first:]
    expected = outer - across.T @ np.linalg.solve(inner, across)
    found = _schur_complement(matrix, KEPT)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    assert np.array_equal(found, found.T)


def test_what_is_not_positive_definite_is_refused() -> None:
    matrix, _ = columns(shift=100.0)
    with pytest.raises(SolveError, match="over the face"):
        _schur_complement(matrix, KEPT)
