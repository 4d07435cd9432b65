"""Memory of fronts: as large as the tree says, whatever it held before, and summed like dense matrices."""

from types import SimpleNamespace

import numpy as np
import pytest

from fe_contact.compliance import front_memory
from fe_contact.compliance.elimination_tree import EliminationTree, bisected_tree
from fe_contact.compliance.front_assembly import add_elements, add_updates, pack
from fe_contact.compliance.front_memory import FrontMemory
from fe_contact.compliance.sector_stiffness import ElementStiffness
from fe_contact.compliance.substructure import condense

COLUMNS, ROWS = 9, 7
KEPT = np.array([40, 3, 17, 9])
RANDOM = np.random.default_rng(3)


def sheet() -> tuple[EliminationTree, np.ndarray, ElementStiffness]:
    """Four-node elements with one freedom per node; node 0 is held. Tree, freedoms, matrices."""
    number = np.arange((COLUMNS + 1) * (ROWS + 1)).reshape(ROWS + 1, COLUMNS + 1)
    cells = [(i, j) for j in range(ROWS) for i in range(COLUMNS)]
    nodes = np.array([number[j : j + 2, i : i + 2].ravel() for i, j in cells])
    half = RANDOM.normal(size=(6, 4, 4))
    stiffness = ElementStiffness(half @ half.transpose(0, 2, 1) + 0.1 * np.eye(4), np.arange(len(cells)) % 6)
    return bisected_tree(nodes, nodes - 1, np.array(cells, float), KEPT, 3), nodes - 1, stiffness


def test_updates_wait_apart_and_fill_the_memory_that_the_tree_names():
    tree, _, _ = sheet()
    memory, waiting, most = FrontMemory(tree), 0, 0

    def walk(front):
        """Write a number of its own into each update; its parent finds it as it was."""
        nonlocal waiting, most
        updates = []
        for number, child in enumerate(front.children):
            walk(child)
            value = float(len(child.border) + 1000 * number)
            updates.append((memory.put_update(child, np.full(len(child.border) ** 2, value)), value))
            waiting += child.update_entries - sum(grandchild.update_entries for grandchild in child.children)
            most = max(most, waiting)
        assert all((update == value).all() for update, value in updates)

    walk(tree.root)
    assert most == tree.waiting_entries


def test_all_factors_lie_in_one_piece_of_the_named_size():
    tree, freedoms, stiffness = sheet()
    _, condensation = condense(tree, freedoms, stiffness)
    owner = condensation.factors[0].factor.base
    assert owner.size == tree.factor_entries
    assert all(part.factor.base is owner and part.coupling.base is owner for part in condensation.factors)


def test_factors_take_the_memory_of_those_that_are_gone_and_of_no_others():
    tree, freedoms, stiffness = sheet()
    alone = condense(tree, freedoms, stiffness)[1].expand(np.eye(len(KEPT)))
    with front_memory.shared_factors():
        first = condense(tree, freedoms, stiffness)[1]
        address = first.factors[-1].factor.__array_interface__["data"]
        second = condense(tree, freedoms, stiffness)[1]  # while the first ones are in use
        assert second.factors[-1].factor.__array_interface__["data"] != address
        address = second.factors[-1].factor.__array_interface__["data"]
        first_field, second_field = (made.expand(np.eye(len(KEPT))) for made in (first, second))
        del first, second
        third = condense(tree, freedoms, stiffness)[1]
        assert third.factors[-1].factor.__array_interface__["data"] == address
        third_field = third.expand(np.eye(len(KEPT)))
    assert all(np.array_equal(field, alone) for field in (first_field, second_field, third_field))
    assert condense(tree, freedoms, stiffness)[1].factors[-1].factor.__array_interface__["data"] != address


def test_factors_that_are_a_little_larger_take_the_memory_too():
    """Of two gears of like cost the second may have a few per cent more factors."""
    with front_memory.shared_factors():
        address = front_memory._factor_memory(1000).__array_interface__["data"]
        assert front_memory._factor_memory(1040).__array_interface__["data"] == address
        assert front_memory._factor_memory(3000).size == 3000


def test_what_memory_held_before_changes_nothing(monkeypatch):
    tree, freedoms, stiffness = sheet()
    matrix, condensation = condense(tree, freedoms, stiffness)
    field = condensation.expand(np.eye(len(KEPT)))
    monkeypatch.setattr(front_memory, "np", SimpleNamespace(empty=lambda size: np.full(size, np.nan)))
    again, other = condense(tree, freedoms, stiffness)
    assert np.array_equal(np.tril(again), np.tril(matrix))
    assert np.array_equal(other.expand(np.eye(len(KEPT))), field)


@pytest.mark.parametrize("inner", [0, 1, 4, 9])
def test_a_front_is_the_sum_of_its_children_to_the_last_bit(inner):
    size = 9
    dense, blocks = np.zeros((size, size)), _garbage(inner, size - inner)
    updates = []
    children = np.array([0, 2, 3, 4, 7]), np.array([1, 2, 3, 5, 6, 7, 8])
    for rows in children:
        matrix = RANDOM.normal(size=(len(rows), len(rows)))
        dense[np.ix_(rows, rows)] += matrix
        update = np.empty(len(rows) * (len(rows) + 1) // 2)
        pack(matrix.ravel(order="F"), update)
        updates.append(update)
    add_updates(*blocks, updates[0], children[0], updates[1], children[1], inner)
    _assert_lower_parts(blocks, dense, inner)


def test_elements_are_added_where_they_are_free():
    matrices, inner, size = RANDOM.normal(size=(2, 3, 3)), 2, 5
    matrices += matrices.transpose(0, 2, 1)
    rows, nothing = np.array([[0, 2, -1], [4, 1, 3]]), (np.zeros(0), np.zeros(0, dtype=np.int64))
    blocks, dense = _garbage(inner, size - inner), np.zeros((size, size))
    add_updates(*blocks, *nothing, *nothing, inner)
    add_elements(*blocks, matrices, np.array([1, 0]), rows, inner)
    dense[np.ix_([0, 2], [0, 2])] += matrices[1][:2, :2]
    dense[np.ix_(rows[1], rows[1])] += matrices[0]
    _assert_lower_parts(blocks, dense, inner)


def _garbage(inner: int, border: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the flat blocks of a front, full of what is no number."""
    return np.full(inner**2, np.nan), np.full(border * inner, np.nan), np.full(border**2, np.nan)


def _assert_lower_parts(
    blocks: tuple[np.ndarray, np.ndarray, np.ndarray], dense: np.ndarray, inner: int
) -> None:
    """Compare the lower triangle of a matrix with the blocks of a front."""
    border = len(dense) - inner
    within, below, rest = (
        block.reshape(shape, order="F")
        for block, shape in zip(blocks, ((inner, inner), (border, inner), (border, border)), strict=True)
    )
    assert np.array_equal(np.tril(within), np.tril(dense[:inner, :inner]))
    assert np.array_equal(below, dense[inner:, :inner])
    assert np.array_equal(np.tril(rest), np.tril(dense[inner:, inner:]))
