"""The finest solution has the quantities of its curve, also where a position failed."""

import numpy as np
import pytest

from benchmarks.finest_solution import _quantities

POSITION = np.arange(128) / 128
CURVE = 1e-6 * (5.0 + 2.0 * np.cos(2.0 * np.pi * POSITION) + 0.5 * np.sin(4.0 * np.pi * POSITION))


def test_the_quantities_are_those_of_the_curve():
    found = _quantities(POSITION, CURVE)
    assert found[[0, 2, 3]] == pytest.approx([5e-6, 2e-6, 0.5e-6], rel=1e-5)
    assert found[1] == pytest.approx(np.ptp(CURVE), rel=1e-3)
    assert found[4] < 1e-10


def test_the_neighbors_fake_for_a_position_that_failed():
    failed = np.where(np.arange(128) == 90, np.nan, CURVE)
    assert _quantities(POSITION, failed) == pytest.approx(_quantities(POSITION, CURVE), rel=1e-4, abs=1e-10)


def test_a_curve_of_which_more_failed_is_refused():
    failed = np.where(np.arange(128) % 40 == 1, np.nan, CURVE)
    with pytest.raises(RuntimeError, match="4 of 128 positions"):
        _quantities(POSITION, failed)
