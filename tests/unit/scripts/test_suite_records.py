"""What a run puts on record of the tests that it ran, and keeps of those that it left out."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import suite_records
import suite_selection
from suite_records import MIN, SuiteRecords
from suite_selection import SLOW, digest, read_costs, read_passed

THIS = "tests/unit/scripts/test_suite_records.py"
OTHER = "tests/unit/scripts/test_suite_selection.py"
BEFORE = {f"{THIS}::long": 4.0, f"{THIS}::removed": 2.0, f"{OTHER}::slow": 3.0}


@pytest.fixture(autouse=True)
def records(monkeypatch, tmp_path):
    for name in ("COSTS", "PASSED"):
        for module in (suite_records, suite_selection):
            monkeypatch.setattr(module, name, tmp_path / name)
    suite_records._write(
        tmp_path / "COSTS", ("test", "cpu_seconds"), ((t, str(s)) for t, s in BEFORE.items())
    )
    suite_records._write(tmp_path / "PASSED", ("file", "rested_on"), [(THIS, "before"), (OTHER, "before")])


def run(seconds: dict[str, float], *, whole: bool, failed: str = "") -> None:
    records = SuiteRecords()
    records.seconds = {f"{THIS}::{test}": s for test, s in seconds.items()}
    records.failed = {failed}
    config = SimpleNamespace(getoption={"all": whole}.__getitem__)
    session: Any = SimpleNamespace(config=config)
    records.pytest_sessionfinish(session)


def test_a_run_of_all_has_the_last_word_on_its_files():
    run({"long": 4.5, "new": SLOW + 0.1, "cheap": MIN / 2}, whole=True)
    costs = {f"{THIS}::long": 4.5, f"{THIS}::new": SLOW + 0.1, f"{OTHER}::slow": 3.0}
    assert read_costs() == pytest.approx(costs)
    assert read_passed() == {THIS: digest(Path(__file__)), OTHER: "before"}


def test_what_others_computed_first_is_half_forgotten():
    """Tests that share what one of them computes: which pays follows from which of them run."""
    run({"long": 0.1, "removed": 1.5}, whole=True)
    assert read_costs() == pytest.approx(
        {f"{THIS}::long": 2.0, f"{THIS}::removed": 1.5, f"{OTHER}::slow": 3.0}
    )


def test_a_run_by_day_keeps_what_it_left_out():
    run({"new": SLOW + 0.1, "removed": 1.9}, whole=False)
    costs = {f"{THIS}::long": 4.0, f"{THIS}::new": SLOW + 0.1, f"{THIS}::removed": 1.9, f"{OTHER}::slow": 3.0}
    assert read_costs() == pytest.approx(costs)
    assert read_passed() == {THIS: "before", OTHER: "before"}, "its long test did not run"


def test_a_run_by_day_that_left_nothing_slow_out_renews_both():
    run({"long": 4.0, "removed": MIN / 2}, whole=False)
    assert read_passed() == {THIS: digest(Path(__file__)), OTHER: "before"}


def test_a_file_with_a_test_that_failed_has_not_passed():
    run({"long": 4.5}, whole=True, failed=THIS)
    assert read_passed() == {THIS: "before", OTHER: "before"}
