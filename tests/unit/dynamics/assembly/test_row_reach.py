"""What an element moves: the blocks of its own shafts, and nothing beyond."""

import numpy as np

from benchmarks.stages import stages
from dynamics.assembly.assemble import assemble
from dynamics.bodies import TimeLaw
from tests.fakes.geared_scenes import spring_table

SPAN = 1e-5


def _arrays(count):
    return assemble(stages(spring_table(3e8), count, 0.1, TimeLaw.constant(50.0))).arrays


def _beyond(arrays):
    """Freedoms beyond the reach of each row, (R, n)."""
    freedom = np.arange(arrays.mass.shape[0])
    return (freedom < arrays.reach[:, :1]) | (freedom >= arrays.reach[:, 1:])


def test_rows_reach_every_freedom_their_forces_move():
    arrays = _arrays(3)
    stage = arrays.mass + SPAN * (arrays.damping + SPAN * arrays.stiffness)
    moved, beyond = np.linalg.solve(stage, arrays.direction.T).T, _beyond(arrays)
    assert np.any(beyond)
    assert np.all(np.abs(moved[beyond]) <= 1e-14 * np.max(np.abs(moved)))
    assert not np.any(arrays.direction[beyond])


def test_reach_does_not_grow_with_the_number_of_stages():
    """So that the cost of a step grows with the meshes, not with meshes times freedoms."""
    few, many = (np.max(np.diff(_arrays(count).reach)) for count in (3, 6))
    assert many == few
