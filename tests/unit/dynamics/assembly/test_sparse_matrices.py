"""Matrices by their entries: nothing of them is lost, and they grow with the parts of a scene alone."""

import numpy as np

from benchmarks.stages import stages
from dynamics.arrays.sparse_rows import subtract_resistance
from dynamics.assembly.assemble import assemble
from dynamics.integrators.implicit_step import invert
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.loads import TimeLaw
from tests.fakes.geared_scenes import spring_table

SPAN = 1e-5


@compiled
def resistance_left(sparse, q, v, force):
    subtract_resistance(sparse, q, v, force)


def _arrays(count):
    return assemble(stages(spring_table(3e8), count, 0.1, TimeLaw.constant(50.0))).arrays


def _dense(rows, columns):
    row = np.repeat(np.arange(rows.first.size - 1), np.diff(rows.first))
    matrix = np.zeros((rows.first.size - 1, columns))
    matrix[row, rows.column] = rows.weight
    return matrix


def test_entries_are_those_of_the_matrices():
    arrays = _arrays(2)
    size = arrays.mass.shape[0]
    for name in ("damping", "stiffness", "direction", "turn"):
        np.testing.assert_array_equal(_dense(getattr(arrays.sparse, name), size), getattr(arrays, name))
    moved = _dense(arrays.sparse.mobility, size) @ arrays.mass
    np.testing.assert_allclose(moved, np.eye(size), atol=1e-14)


def test_couplings_hold_every_entry_of_the_inverse_of_a_stage():
    arrays = _arrays(3)
    stage = arrays.mass + SPAN * (arrays.damping + SPAN * arrays.stiffness)
    inverse = stage.copy()
    invert(inverse)
    np.testing.assert_allclose(inverse @ stage, np.eye(stage.shape[0]), atol=1e-12)
    joined = _dense(arrays.sparse.coupling, stage.shape[0]) != 0.0
    assert not np.all(joined)
    assert not np.any(inverse[~joined])


def test_entries_grow_in_proportion_to_the_stages():
    """So that the cost of a step grows with the meshes, not with meshes times freedoms."""
    few, many = (_arrays(count).sparse for count in (3, 6))
    for rows in ("direction", "stiffness", "mobility"):
        assert getattr(many, rows).column.size <= 2 * getattr(few, rows).column.size + 8


def test_changed_matrices_take_their_entries_along():
    arrays = _arrays(1)
    changed = arrays.with_matrices(damping=2.0 * arrays.damping)
    np.testing.assert_array_equal(_dense(changed.sparse.damping, arrays.mass.shape[0]), 2.0 * arrays.damping)


def test_dampers_and_springs_act_by_both_matrices_wherever_either_has_entries():
    arrays = _arrays(2)
    size, rng = arrays.mass.shape[0], np.random.default_rng(2)
    arrays = arrays.with_matrices(
        damping=np.where(rng.random((size, size)) < 0.2, rng.random((size, size)), 0.0),
        stiffness=np.where(rng.random((size, size)) < 0.2, rng.random((size, size)), 0.0),
    )
    q, v, force = rng.random(size), rng.random(size), rng.random(size)
    left = force.copy()
    resistance_left(by_address(arrays.sparse), q, v, left)
    np.testing.assert_allclose(left, force - arrays.damping @ v - arrays.stiffness @ q, rtol=1e-13)
