"""The step levels are left by a rejected step of the smallest size alone."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dynamics.integrators.advance import Control, next_level
from dynamics.integrators.workspace import Count, geometric_steps

STEP_SIZES = geometric_steps(1e-3, 1e-8)
SMALLEST = STEP_SIZES.size - 2  # behind it the step that lands on a law's knot
CONTROL = Control(True, True, False, 3, 1e-9, 1e-4, 100)


def after(level: int, error: float, accepted: bool, last: float = 1e-4) -> int:
    counts = np.zeros(len(Count), dtype=np.int64)
    counts[Count.LEVEL] = level
    work = SimpleNamespace(step_sizes=STEP_SIZES, counts=counts, error=np.array([last]))
    return next_level.py_func(work, CONTROL, error, accepted)


@pytest.mark.parametrize("error", [0.0, 1e-6, 0.5, 1.0])
@pytest.mark.parametrize("last", [1e-4, 1.0])
def test_an_accepted_step_has_a_step_size(error, last):
    """At the smallest a step just within the tolerance requires a smaller one, which is not there."""
    for level in (0, 5, SMALLEST - 1, SMALLEST):
        assert 0 <= after(level, error, True, last) <= SMALLEST


@pytest.mark.parametrize("error", [1.0001, 1e3, 1e10])
def test_a_rejected_step_falls_by_a_level_at_least_and_one_below_the_smallest_at_most(error):
    for level in (0, 5, SMALLEST - 1, SMALLEST):
        assert level < after(level, error, False) <= SMALLEST + 1
