"""Contact of given compliance: against every possible set of hats, laws, loads that grow."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fe_contact.full_contact.condensation.linearized_contact import ContactSystem, solve_active_set


def system(seed: int, hats: int = 7) -> ContactSystem:
    """Hats with random gaps on a random body."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(hats, hats))
    closing = random.uniform(0.5, 1.5, hats)
    lever = closing * random.uniform(0.99, 1.01, hats)
    return ContactSystem(
        gap=random.uniform(0.0, 3.0, hats),
        compliance=root @ root.T / hats + 0.2 * np.eye(hats),
        closing=closing,
        lever=lever,
        weight=closing,
    )


def by_enumeration(s: ContactSystem, torque: float) -> list[tuple[np.ndarray, float]]:
    """All sets of hats whose solution keeps the laws."""
    count, kept = len(s.gap), []
    for chosen in itertools.product([False, True], repeat=count):
        active = np.array(chosen)
        if not active.any():
            continue
        size = int(active.sum())
        matrix = np.zeros((size + 1, size + 1))
        matrix[:size, :size] = s.compliance[np.ix_(active, active)]
        matrix[:size, size], matrix[size, :size] = -s.closing[active], s.lever[active]
        solved = np.linalg.solve(matrix, np.append(-s.gap[active], torque))
        pressure = np.zeros(count)
        pressure[active] = solved[:size]
        gap = s.gap + s.compliance @ pressure - s.closing * solved[size]
        if pressure.min() >= 0.0 and gap.min() > -1e-10:
            kept.append((pressure, float(solved[size])))
    return kept


@pytest.mark.parametrize("seed", range(12))
def test_it_finds_the_one_set_that_keeps_the_laws(seed: int) -> None:
    case = system(seed)
    ((pressure, lag),) = by_enumeration(case, 2.0)
    solution = solve_active_set(case, 2.0)
    assert solution.status.usable
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0.0, atol=1e-10)
    assert solution.lag == pytest.approx(lag, rel=1e-10)
    assert solution.residual < 1e-12


def test_the_lag_grows_with_the_torque_from_wherever_it_starts() -> None:
    case = system(5, hats=40)
    torques = np.geomspace(1e-3, 1e3, 25)
    lags = [solve_active_set(case, torque).lag for torque in torques]
    assert np.all(np.diff(lags) > 0.0)
    everywhere = solve_active_set(case, 1.0, np.ones(40, dtype=bool))
    assert everywhere.lag == pytest.approx(solve_active_set(case, 1.0).lag, rel=1e-12)
