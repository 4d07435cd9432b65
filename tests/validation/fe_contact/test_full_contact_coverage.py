"""Stated errors against full contact: pairs of six regimes, half of which set no constant."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.full_contact_cases import full_contact_cases
from benchmarks.full_contact_coverage import QUANTITIES, Assessed, assess

SOURCE = "full finite-element contact by condensation, plane strain, its own convergence forgiven"
LEAST_COVERAGE, LARGEST_RATIO = (95.0, 95.0, 90.0, 90.0, 90.0), 3.0


@pytest.fixture(scope="module")
def held_out() -> list[Assessed]:
    cases = [case for case in full_contact_cases() if case.held_out]
    assert len({case.regime for case in cases}) >= 6
    return [assess(case, "standard") for case in cases]


@pytest.mark.parametrize("q", range(len(QUANTITIES)), ids=QUANTITIES)
def test_stated_errors_cover_full_contact(held_out, q, record_figure) -> None:
    covered = 100.0 * np.concatenate([one.covered[q] for one in held_out]).mean()
    least = LEAST_COVERAGE[q]
    record_figure(f"{QUANTITIES[q]}: curves covered", covered, f"at least {least:g} %", "%", SOURCE)
    assert covered >= least


@pytest.mark.parametrize("q", range(2), ids=QUANTITIES[:2])
def test_they_are_not_much_too_large(held_out, q, record_figure) -> None:
    ratio = float(np.median(np.concatenate([one.ratio[q] for one in held_out])))
    record_figure(f"{QUANTITIES[q]}: median stated over true error", ratio, "at most 3", "-", SOURCE)
    assert ratio <= LARGEST_RATIO


@pytest.mark.law
def test_no_level_states_less_than_was_ever_proved(held_out) -> None:
    for one in (*held_out, assess(held_out[0].case, "fine")):
        assert np.all(one.stated[0] >= 4e-4 * one.value[0])
