"""Orderings that keep the factor sparse."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fe_contact.compliance.ring_2d import _nested_dissection, factorise


def grid(n: int) -> sp.csc_array:
    """Positive definite matrix of a square grid of n x n nodes with two freedoms each."""
    line = sp.diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(n, n))
    eye = sp.eye_array(n)
    nodes = sp.kron(line, eye) + sp.kron(eye, line)
    return sp.csc_array(sp.kron(nodes, np.array([[2.0, 1.0], [1.0, 2.0]])))


def fill(matrix: sp.csc_array, order: np.ndarray) -> int:
    permuted = sp.csc_array(matrix[order][:, order])
    factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return int(factor.L.nnz)


def test_nested_dissection_orders_whole_nodes_and_saves_fill() -> None:
    matrix = grid(60)
    order = _nested_dissection(matrix, 2)
    assert np.array_equal(np.sort(order), np.arange(matrix.shape[0]))
    assert np.array_equal(order[1::2], order[::2] + 1)
    assert np.all(order[::2] % 2 == 0)
    assert fill(matrix, order) < 0.5 * fill(matrix, np.arange(matrix.shape[0]))
    assert fill(matrix, order) < 0.5 * fill(matrix, np.argsort(order))  # the inverse order is a trap


def test_solves_many_right_hand_sides_in_their_own_order() -> None:
    matrix = grid(12)
    exact = np.random.default_rng(1).standard_normal((matrix.shape[0], 7))
    assert factorise(matrix, block=2)(matrix @ exact) == pytest.approx(exact, abs=1e-12)
