"""Merits to first order: the program's least is the least of the linear curves and limits themselves."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.microgeometry.objective import LinearMerit, Objective, WeightedMean, Worst

DIMENSIONS, NODES, POSITIONS, LOADS = 3, 2, 20, 2
LOW, HIGH = np.full(DIMENSIONS, -0.2), np.array([0.2, 0.1, 0.0])


def some(objective: Objective, seed: int, limits: int = 1) -> LinearMerit:
    rng = np.random.default_rng(seed)
    rows = tuple((rng.normal(size=9) - 1.0, rng.normal(size=(9, DIMENSIONS))) for _ in range(limits))
    return LinearMerit(
        5.0 + rng.normal(size=(NODES, POSITIONS, LOADS)),
        rng.normal(size=(NODES, POSITIONS, LOADS, DIMENSIONS)),
        np.array([0.25, 0.75]),
        objective.rows(LOADS),
        rows,
        10.0,
    )


def value(merit: LinearMerit, step: np.ndarray) -> float:
    """Merit at a step, without any program."""
    ripple = np.ptp(merit.curves + merit.by @ step, axis=1)
    found = float((merit.load_weight @ (merit.node_weight @ ripple)).max())
    for rows, by in merit.limits:
        found += merit.penalty * max(0.0, float((rows + by @ step).max()))
    return found


@pytest.mark.parametrize("objective", [WeightedMean((1.0, 3.0)), Worst()])
@pytest.mark.parametrize("seed", range(5))
def test_the_least_is_that_of_the_merit_itself(objective, seed):
    merit = some(objective, seed)
    step, promised = merit.least(LOW, HIGH)
    assert ((step >= LOW - 1e-9) & (step <= HIGH + 1e-9)).all()
    assert promised == pytest.approx(value(merit, step), rel=1e-7)
    rng = np.random.default_rng(seed)
    others = rng.uniform(LOW, HIGH, size=(2000, DIMENSIONS))
    assert min(value(merit, other) for other in others) >= promised - 1e-7


def test_objectives_are_the_largest_of_their_rows():
    expected = np.array([2.0, 5.0, 1.0])
    for objective in (WeightedMean(), WeightedMean((1.0, 0.0, 2.0)), Worst()):
        assert (objective.rows(3) @ expected).max() == pytest.approx(objective.of(expected), rel=1e-12)
