"""Dense substructures and cyclic harmonics against plain dense algebra on small random structures."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.compliance.cyclic_ring import close_ring, hold_sector
from fe_contact.compliance.elimination_tree import EliminationTree, _elimination_tree
from fe_contact.compliance.sector_stiffness import ElementStiffness
from fe_contact.compliance.substructure import condense
from fe_contact.errors import SolveError

RANDOM = np.random.default_rng(7)
COLUMNS, ROWS = 7, 5
KEPT = np.array([40, 3, 17, 9])


def sheet(floor: float = 0.1) -> tuple[np.ndarray, np.ndarray, np.ndarray, ElementStiffness]:
    """Four-node elements with one freedom per node; node 0 is held. Nodes, freedoms, places, matrices."""
    number = np.arange((COLUMNS + 1) * (ROWS + 1)).reshape(ROWS + 1, COLUMNS + 1)
    cells = [(i, j) for j in range(ROWS) for i in range(COLUMNS)]
    nodes = np.array([number[j : j + 2, i : i + 2].ravel() for i, j in cells])
    half = RANDOM.normal(size=(6, 4, 4))
    matrices = half @ half.transpose(0, 2, 1) + floor * np.eye(4)
    return nodes, nodes - 1, np.array(cells, float), ElementStiffness(matrices, np.arange(len(cells)) % 6)


def dense(freedoms: np.ndarray, stiffness: ElementStiffness) -> np.ndarray:
    matrix = np.zeros((freedoms.max() + 1,) * 2)
    for dofs, which in zip(freedoms, stiffness.of_element, strict=True):
        free = dofs >= 0
        matrix[np.ix_(dofs[free], dofs[free])] += stiffness.matrices[which][np.ix_(free, free)]
    return matrix


@pytest.mark.parametrize("leaf", [1, 3, 100])
def test_condensation_is_the_schur_complement(leaf: int) -> None:
    nodes, freedoms, place, stiffness = sheet()
    tree = _elimination_tree(nodes, freedoms, place, KEPT, leaf)
    found = condense(tree, freedoms, stiffness)
    matrix = dense(freedoms, stiffness)
    others = np.setdiff1d(np.arange(len(matrix)), KEPT)
    exact = matrix[np.ix_(KEPT, KEPT)] - matrix[np.ix_(KEPT, others)] @ np.linalg.solve(
        matrix[np.ix_(others, others)], matrix[np.ix_(others, KEPT)]
    )
    assert np.array_equal(found.kept, KEPT)
    assert np.tril(found.matrix) == pytest.approx(np.tril(exact), abs=1e-12)
    values = RANDOM.normal(size=(len(KEPT), 2))
    field = found.expand(values)
    assert np.array_equal(field[KEPT], values)
    assert np.abs((matrix @ field)[others]).max() < 1e-12
    assert (matrix @ field)[KEPT] == pytest.approx(exact @ values, abs=1e-12)


def test_every_freedom_is_eliminated_once_and_counted() -> None:
    nodes, freedoms, place, _ = sheet()
    tree: EliminationTree = _elimination_tree(nodes, freedoms, place, KEPT, 3)
    inner = np.concatenate([front.inner for front in tree.root.fronts()])
    assert sorted(np.concatenate([inner, KEPT])) == list(range(len(tree.order)))
    assert np.array_equal(np.argsort(tree.order)[: len(inner)], inner)
    assert sorted(np.concatenate([f.elements for f in tree.root.fronts()])) == list(range(COLUMNS * ROWS))
    alone = _elimination_tree(nodes, freedoms, place, KEPT, 100)
    n, k = len(inner), len(KEPT)
    assert alone.operations == pytest.approx(n**3 / 6 + n * n * k / 2 + n * k * k / 2)
    assert (alone.factor_entries, alone.front_entries, alone.front_count) == (n * (n + k), (n + k) ** 2, 1)
    assert alone.working_entries() == 2 * (n + k) ** 2
    assert tree.operations < alone.operations
    assert tree.factor_entries < alone.factor_entries


def test_an_indefinite_structure_is_a_solve_error() -> None:
    nodes, freedoms, place, stiffness = sheet(floor=-50.0)
    with pytest.raises(SolveError, match="not positive definite"):
        condense(_elimination_tree(nodes, freedoms, place, KEPT, 3), freedoms, stiffness)


FLANK, CUT = 9, 4


def random_sector() -> np.ndarray:
    half = RANDOM.normal(size=(FLANK + 2 * CUT, 40))
    return half @ half.T


@pytest.mark.parametrize("teeth", [2, 3, 7, 8])
def test_ring_equals_the_dense_ring(teeth: int) -> None:
    matrix = random_sector()
    own = FLANK + CUT  # flank and left cut of each sector
    ring = np.zeros((teeth * own, teeth * own))
    for j in range(teeth):
        mine = np.arange(j * own, (j + 1) * own)
        right = (j - 1) % teeth * own + FLANK + np.arange(CUT)
        at = np.concatenate([mine, right])
        ring[np.ix_(at, at)] += matrix
    inverse = np.linalg.inv(ring)
    probes = RANDOM.normal(size=(FLANK, 2))
    reach = teeth // 2
    junk = matrix + np.triu(np.full_like(matrix, 1e6), 1)  # only the lower triangle may count
    held = hold_sector(np.asfortranarray(junk), FLANK)
    found = close_ring(held, teeth, reach, probes)
    flank = [slice(j * own, j * own + FLANK) for j in range(teeth)]
    for m in range(reach + 1):
        assert found.blocks[m] == pytest.approx(inverse[flank[m], flank[0]], rel=1e-9, abs=1e-12)
        assert pytest.approx(inverse[flank[-m % teeth], flank[0]], rel=1e-9, abs=1e-12) == found.blocks[m].T
    for j in range(teeth):
        left = slice(j * own + FLANK, (j + 1) * own)
        assert found.left[j] == pytest.approx(inverse[left, flank[0]] @ probes, rel=1e-9, abs=1e-12)
        assert np.array_equal(found.right[j], found.left[j - 1])
    assert found.rank <= 2 * CUT


def test_an_unsupported_ring_is_a_solve_error() -> None:
    spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
    matrix = np.zeros((FLANK + 2 * CUT,) * 2)
    matrix[:FLANK, :FLANK] = np.eye(FLANK)
    matrix[FLANK:, FLANK:] = np.kron(spring, np.eye(CUT))
    matrix[FLANK:, :FLANK] = 0.0
    held = hold_sector(np.asfortranarray(matrix), FLANK)
    with pytest.raises(SolveError, match="harmonic 0"):
        close_ring(held, 6, 1, np.ones((FLANK, 1)))
    with pytest.raises(SolveError, match="flank"):
        hold_sector(np.asfortranarray(-matrix), FLANK)
