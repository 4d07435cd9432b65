"""The study of the tolerance counts what it says it counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import tolerance_promise
from benchmarks.honesty_cases import face_cases, plane_cases
from benchmarks.measured_rungs import Measured, RungOf
from benchmarks.tolerance_promise import Kept, Ran, counts, judge, markdown

GOOD = Kept("spur", False, "corrected draft", 1, True, 0.004, 1.0, "corrected draft", 1.0)
DEAR = Kept("helical", True, "3d fine, 91 slices", 3, True, 0.002, 9.0, "3d draft, 61 slices", 3.0)
MISSED = Kept("steep", True, "3d fine, 91 slices", 2, False, 0.03, 40.0, "", float("nan"))


def test_misses_and_prices_are_counted() -> None:
    rows = {figure.what: figure.value for figure in counts([GOOD, DEAR, MISSED, GOOD])}
    assert rows["not met"] == pytest.approx(25.0)
    assert rows["not met (held out)"] == pytest.approx(50.0)
    assert rows["price above 2.5"] == pytest.approx(100.0 / 3.0)
    assert rows["median price (held out)"] == pytest.approx(3.0)
    assert rows["stated to be met and not met"] == 0.0
    wrong = counts([GOOD, DEAR, replace(MISSED, stated=True), GOOD])
    assert next(f.value for f in wrong if f.what == "stated to be met and not met") == pytest.approx(25.0)


def test_the_page_marks_what_was_missed_and_what_its_receipt_says() -> None:
    text = markdown([GOOD, DEAR, MISSED])
    assert (
        "| steep* | 3d fine, 91 slices (not met by its receipt) | 2 | **3** | 40 | none | nan | - |" in text
    )
    assert "met in 67 %, of those held out in 50 %;" in text


def test_the_price_is_that_over_the_quickest_rung_that_met_it(monkeypatch) -> None:
    """Draft errs by 2 %, standard by 0.5 %, everything else is exact and slow; the run takes both."""
    exact = np.array([[10e-6], [4e-6], [1e-6]])
    kinds = {"draft": (1.02, 1.0), "standard": (1.005, 2.0)}

    def made(_case, rung: RungOf) -> Measured:
        part, seconds = kinds.get(rung.level, (1.0, 9.0)) if rung.model == "corrected" else (1.0, 9.0)
        return Measured(part * exact, exact, {"contact": seconds}, {}, {})

    monkeypatch.setattr(tolerance_promise, "measured", made)
    ran = Ran(RungOf("corrected", "standard"), 2, True, 1.005 * exact[:2], 3.1)
    monkeypatch.setattr(tolerance_promise, "run", lambda _: ran)
    found = judge(plane_cases()[0], held_out=False)
    assert (found.rung, found.passes) == ("corrected standard", 2)
    assert found.error == pytest.approx(0.005)
    assert found.met
    assert (found.cheapest, found.least) == ("corrected standard", 2.0)
    assert found.price == 3.1 / 2.0


def test_a_run_is_that_of_a_caller_with_all_its_passes() -> None:
    """On the plane's quickest pair."""
    ran = tolerance_promise.run(plane_cases()[0])
    assert ran.rung == RungOf("corrected", "draft")
    assert (ran.passes, ran.stated) == (1, True)
    assert ran.value.shape == (2, len(plane_cases()[0].forces))
    assert ran.seconds > 0.0


def test_a_pair_of_three_dimensions_is_held_against_its_own_truth(monkeypatch) -> None:
    exact = np.array([[10e-6, 20e-6], [4e-6, 5e-6], [1e-6, 1e-6]])
    monkeypatch.setattr(tolerance_promise, "truth", lambda _: exact)
    off = Measured(exact * [[1.0, 1.0], [1.0, 0.991], [2.0, 2.0]], exact, {"contact": 1.0}, {}, {})
    monkeypatch.setattr(tolerance_promise, "measured", lambda *_: off)
    ran = Ran(RungOf("3d", "draft", 15), 1, True, off.value[:2], 1.0)
    monkeypatch.setattr(tolerance_promise, "run", lambda _: ran)
    found = judge(face_cases()[0], held_out=False)
    assert found.error == pytest.approx(0.009)  # harmonics are not promised
    assert found.met
