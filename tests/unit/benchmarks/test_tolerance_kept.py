"""The study of the tolerance counts what it says it counts."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import tolerance_kept
from benchmarks.drawn_pairs import drawn_pairs
from benchmarks.stored_runs import StoredRun
from benchmarks.tolerance_kept import ToleranceRun, assess, counts, markdown, used

GOOD = ToleranceRun("spur", "draft", 1, True, 0.4, 0.2, 1.0, 1.0, 1.0)
DEAR = ToleranceRun("helical", "fine, 15 slices", 3, True, 0.9, 0.2, 9.0, 3.0, 1.0)
MISSED = ToleranceRun("steep", "fine, 31 slices", 2, False, 1.2, 3.0, 40.0, float("nan"), float("nan"))
HELICAL = drawn_pairs(3, 2)[1]


def test_misses_and_prices_are_counted():
    rows = {figure.what: figure.value for figure in counts([GOOD, DEAR, MISSED, GOOD])}
    assert rows["not met as measured"] == pytest.approx(25.0)
    assert rows["true error beyond the tolerance"] == pytest.approx(25.0)
    assert rows["price above 2.5 times the cheapest by stated errors"] == pytest.approx(100.0 / 3.0)
    assert rows["said to be met where more is stated"] == 0.0
    wrong = counts([GOOD, DEAR, replace(MISSED, met=True), GOOD])
    assert next(f.value for f in wrong if f.what.startswith("said to be met")) == pytest.approx(25.0)


def test_the_page_marks_what_is_missed_and_what_its_receipt_says():
    text = markdown([GOOD, DEAR, MISSED])
    assert "| steep | fine, 31 slices (not met) | 2 | **1.2** | **3** | 40 | - | - |" in text
    assert "| met, says the receipt | 67 % |" in text
    assert "| price by true errors | median 5, at most 2.5 in 50 %, worst 9 |" in text


def test_prices_are_those_over_the_quickest_run_whose_errors_are_within(monkeypatch):
    """Draft errs by 0.8 % and states 2 %; standard states 0.5 %; the run refines and pays for both."""
    exact = np.array([[10e-6], [4e-6], [1e-6], [1e-6], [1e-6]])
    runs = {"draft": (1.008, 0.02, 1.0), "standard": (1.005, 0.005, 2.0)}

    def made(_case, level="", tolerance=0.0):
        part, stated, seconds = runs.get(level, (1.005, 0.005, 3.1))
        passes = [
            {"level": "draft", "slices": 15, "kept": False},
            {"level": "standard", "slices": 15, "kept": True},
        ]
        receipt = {
            "cpu_seconds": seconds,
            "passes": passes,
            "tolerance": {"met": bool(tolerance), "reason": "met"},
        }
        sources = np.zeros((6, 5, 1))
        sources[0] = stated * exact
        return StoredRun(part * exact, sources, receipt)

    monkeypatch.setattr(tolerance_kept, "table_run", made)
    monkeypatch.setattr(tolerance_kept, "finest_run", lambda _: exact)
    found = assess(HELICAL)
    assert (found.ended, found.passes, found.met) == ("standard, 15 slices", 2, True)
    assert found.true == pytest.approx(0.5)
    assert (found.price, found.price_in_truth) == (3.1 / 2.0, 3.1)


def test_the_floor_counts_where_it_is_larger_and_harmonics_do_not():
    value = np.array([[10e-6, 10e-6], [4e-6, 0.1e-6], [1e-6, 1e-6]])
    error = np.array([[0.02e-6, 0.01e-6], [0.0, 10e-9], [1e-6, 1e-6]])
    assert used(error, value) == pytest.approx(0.5)  # 10 nm of 20; 0.2 % of 1 %
