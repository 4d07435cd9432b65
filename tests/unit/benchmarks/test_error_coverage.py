"""The study of stated errors counts what it says it counts."""

import numpy as np
import pytest

from benchmarks import error_coverage, stored_runs
from benchmarks.assessed import Assessed, coverage_figures, coverage_table, error_cell
from benchmarks.error_coverage import SHARED, assess, publish
from benchmarks.pair_cases import PairCase, plane_cases
from benchmarks.stored_runs import table_run

VALUE = np.array([[10e-6, 20e-6], [4e-6, 5e-6], [2e-6, 3e-6], [1e-6, 1e-6], [1e-6, 1e-6]])
TRUE = 0.01 * VALUE
COVERED = Assessed("spur", "corrected plane, draft", VALUE, 3.0 * TRUE, TRUE)
MISSED = Assessed("steep", "helical, standard", VALUE, 0.5 * TRUE, TRUE)
MARKS = [f"<!-- {word} finest: written by scripts/bench --publish -->" for word in ("begin", "end")]


def test_what_is_not_covered_is_counted():
    rows = {figure.what: figure for figure in coverage_figures([COVERED] * 3 + [MISSED], "errors", 90.0)}
    assert rows["mean: not covered"].value == pytest.approx(25.0)
    assert rows["mean: not covered"].met is False
    assert rows["harmonic 3: median stated over true"].value == pytest.approx(3.0)


def test_the_error_of_the_reference_is_forgiven_and_no_ratio_is_taken_to_less():
    half = Assessed("steep", "", VALUE, 0.5 * TRUE, TRUE, own=0.6 * TRUE)
    assert half.covered.all()
    assert np.allclose(half.ratio, 0.5)
    exact = Assessed("spur", "", VALUE, TRUE, 0.0 * TRUE, own=2.0 * TRUE)
    assert np.allclose(exact.ratio, 0.5)
    assert np.all(np.isfinite(Assessed("spur", "", VALUE, TRUE, 0.0 * TRUE).ratio))


@pytest.fixture
def page(tmp_path, monkeypatch):
    """A page, and tables in full that nobody computes."""
    page = tmp_path / "accuracy.md"
    monkeypatch.setattr(error_coverage, "PAGE", page)
    monkeypatch.setattr(error_coverage, "in_full", lambda: (COVERED, MISSED))
    return page


def test_the_page_shows_every_table_and_marks_what_is_missed(page):
    page.write_text(f"before\n{MARKS[0]}\nstale figures\n{MARKS[1]}\nafter\n")
    publish([COVERED, MISSED], {"lineofaction": "1", "numpy": "2", "scipy": "3"})
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith("after\n") and "stale" not in text
    assert "| spur | draft | 1 (3) | 1 (3) | 1 (3) |" in text
    assert "| steep | standard | **1 (0.5)** |" in text
    assert error_cell(MISSED, 0, 0) == "**1 (0.5)**"
    assert "| missed | 2 | 0 %, 0.5 |" in coverage_table({"missed": [MISSED], "none": []})


def test_a_page_without_the_section_gets_one_and_keeps_its_text(page):
    page.write_text("nothing to replace\n")
    for _ in range(2):  # the second time there is one
        publish([COVERED], {"lineofaction": "1", "numpy": "2", "scipy": "3"})
    text = page.read_text()
    assert text.startswith("nothing to replace\n")
    assert text.count(MARKS[0]) == text.count(MARKS[1]) == text.count("| spur | draft |") == 1


def test_a_table_is_assessed_from_end_to_end_and_stored(tmp_path, monkeypatch):
    monkeypatch.setattr(stored_runs, "FILE", tmp_path / "runs.jsonl")
    plane = {"model": "plane_strain"}
    case = PairCase("spur", plane_cases()[0].pair, (1.0,), plane)
    found = assess(case, "draft")
    assert np.all(found.true > 0.0)
    run = table_run(case, level="draft")
    assert np.array_equal(found.stated, run.stated(*SHARED))
    assert np.all(run.stated() > found.stated)
    monkeypatch.setattr(stored_runs, "analyze", lambda *_, **__: pytest.fail("measured again"))
    assert np.array_equal(assess(case, "draft").stated, found.stated)
    with pytest.raises(pytest.fail.Exception):
        table_run(PairCase("spur", plane_cases()[1].pair, (1.0,), plane), level="draft")
