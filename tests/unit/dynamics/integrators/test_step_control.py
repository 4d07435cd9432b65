"""The ladder of step sizes is never left but by a rejected step at its foot."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dynamics.integrators.step_control import Control, next_rung
from dynamics.integrators.workspace import Count, step_ladder

LADDER = step_ladder(1e-3, 1e-8)
FOOT = LADDER.size - 3  # behind it the step that lands on a law's knot, and 0
CONTROL = Control(True, True, False, 3, 1e-9, 1e-4, 100)


def after(rung: int, error: float, accepted: bool, last: float = 1e-4) -> int:
    counts = np.zeros(len(Count), dtype=np.int64)
    counts[Count.RUNG] = rung
    work = SimpleNamespace(ladder=LADDER, counts=counts, error=np.array([last]))
    return next_rung.py_func(work, CONTROL, error, accepted)


@pytest.mark.parametrize("error", [0.0, 1e-6, 0.5, 1.0])
@pytest.mark.parametrize("last", [1e-4, 1.0])
def test_an_accepted_step_stays_on_the_ladder(error, last):
    """At the foot a step just within the tolerance asked for a smaller one, which is not there."""
    for rung in (0, 5, FOOT - 1, FOOT):
        assert 0 <= after(rung, error, True, last) <= FOOT


@pytest.mark.parametrize("error", [1.0001, 1e3, 1e10])
def test_a_rejected_step_falls_by_a_rung_at_least_and_one_below_the_foot_at_most(error):
    for rung in (0, 5, FOOT - 1, FOOT):
        assert rung < after(rung, error, False) <= FOOT + 1
