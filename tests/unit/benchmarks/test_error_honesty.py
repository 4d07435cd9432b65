"""The study of error estimates counts what it says it counts."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import error_honesty
from benchmarks.error_honesty import Judged, counts, markdown, publish
from benchmarks.finest_rung import finest
from benchmarks.honesty_cases import HonestyCase, face_cases, plane_cases

VALUE = np.array([[10e-6, 20e-6], [4e-6, 5e-6], [2e-6, 3e-6]])
TRUE = 0.01 * VALUE
HELD = Judged("spur 20/20", "draft", VALUE, 3.0 * TRUE, TRUE)
MISSED = Judged("helical 18/23", "draft", VALUE, 0.5 * TRUE, TRUE)


def test_what_is_beyond_the_estimate_is_counted() -> None:
    rows = {figure.what: figure for figure in counts([HELD, HELD, HELD, MISSED])}
    assert rows["mean: true error beyond the estimate"].value == pytest.approx(25.0)
    assert rows["mean: true error beyond the estimate"].met is False
    assert rows["peak-to-peak: median over-estimate"].value == pytest.approx(3.0)


def test_the_page_shows_every_case_and_marks_what_was_missed(tmp_path, monkeypatch) -> None:
    page = tmp_path / "accuracy.md"
    page.write_text(f"before\n{error_honesty.MARKS[0]}\nstale figures\n{error_honesty.MARKS[1]}\nafter\n")
    monkeypatch.setattr(error_honesty, "PAGE", page)
    publish([HELD, MISSED], {"lineofaction": "1", "numpy": "2", "scipy": "3"})
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "stale" not in text
    assert "| spur 20/20 | draft | 3 / 1 | 3 / 1 | 3 / 1 |" in text
    assert "| helical 18/23 | draft | **0.5 / 1** |" in text
    assert "| plane, draft | 2 | 100 % | 3 |" in markdown([HELD, MISSED])


def test_the_study_has_the_cases_that_it_promises() -> None:
    cases = [*plane_cases(), *face_cases()]
    assert sum(len(case.levels) for case in cases) >= 24
    assert len({case.name for case in cases}) == len(cases)


def test_a_case_is_judged_from_end_to_end(tmp_path) -> None:
    case = plane_cases()[0]
    (found,) = error_honesty.study([HonestyCase(case.name, case.pair, ("draft",), (1.0,))], tmp_path)
    assert np.all(found.true > 0.0)
    assert np.all(found.ratio > 1.0)
    assert finest(case, tmp_path).mean.shape == (3,)
