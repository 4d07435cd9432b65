"""The study of error estimates counts what it says it counts."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import error_honesty, measured_rungs
from benchmarks.error_honesty import Judged, counts, markdown, publish
from benchmarks.held_out_cases import held_out_face_cases, held_out_plane_cases
from benchmarks.honesty_cases import HonestyCase, face_cases, plane_cases
from benchmarks.measured_rungs import RungOf, needs_face

VALUE = np.array([[10e-6, 20e-6], [4e-6, 5e-6], [2e-6, 3e-6]])
TRUE = 0.01 * VALUE
HELD = Judged("spur 20/20", "corrected draft", VALUE, 3.0 * TRUE, TRUE)
MISSED = Judged("helical 21/34, wide", "3d draft, 15 slices", VALUE, 0.5 * TRUE, TRUE)
MARKS = [f"<!-- {word} honesty: written by scripts/bench --publish -->" for word in ("begin", "end")]


def test_what_is_beyond_the_estimate_is_counted() -> None:
    rows = {figure.what: figure for figure in counts([HELD, HELD, HELD, MISSED])}
    assert rows["mean: true error beyond the estimate"].value == pytest.approx(25.0)
    assert rows["mean: true error beyond the estimate"].met is False
    assert rows["peak-to-peak: median over-estimate"].value == pytest.approx(3.0)


def test_the_page_shows_every_case_and_marks_what_was_missed(tmp_path, monkeypatch) -> None:
    page = tmp_path / "accuracy.md"
    page.write_text(f"before\n{MARKS[0]}\nstale figures\n{MARKS[1]}\nafter\n")
    monkeypatch.setattr(error_honesty, "PAGE", page)
    publish([HELD, MISSED], {"lineofaction": "1", "numpy": "2", "scipy": "3"})
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "stale" not in text
    assert "| spur 20/20 | corrected draft | 3 / 1 | 3 / 1 | 3 / 1 |" in text
    assert "| helical 21/34, wide* | 3d draft, 15 slices | **0.5 / 1** |" in text
    assert "| held out of every fit | 2 | 0 % | 0.5 |" in markdown([HELD, MISSED])


def test_a_page_without_the_section_is_refused(tmp_path, monkeypatch) -> None:
    page = tmp_path / "accuracy.md"
    page.write_text("nothing to replace\n")
    monkeypatch.setattr(error_honesty, "PAGE", page)
    with pytest.raises(ValueError, match="no section"):
        publish([HELD], {"lineofaction": "1", "numpy": "2", "scipy": "3"})


def test_the_study_has_the_cases_that_it_promises() -> None:
    """And none of those held out is among the others, under another name."""
    known, held_out = [*plane_cases(), *face_cases()], [*held_out_plane_cases(), *held_out_face_cases()]
    assert len(known) + len(held_out) >= 24
    assert len(held_out) >= 12
    names = [case.name for case in (*known, *held_out)]
    assert len(set(names)) == len(names)
    assert not {repr(case.pair) for case in known} & {repr(case.pair) for case in held_out}


def test_what_needs_three_dimensions_is_told_by_the_effects() -> None:
    assert not needs_face(plane_cases()[0])
    assert all(needs_face(case) for case in (*face_cases(), *held_out_face_cases()))


def test_a_case_is_judged_from_end_to_end_and_kept(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(measured_rungs, "ROOT", tmp_path)
    monkeypatch.setattr(error_honesty, "judged_rungs", lambda _: [RungOf("corrected", "draft")])
    case = HonestyCase(plane_cases()[0].name, plane_cases()[0].pair, (1.0,))
    (found,) = error_honesty.study([case])
    assert np.all(found.true > 0.0)
    assert np.all(found.ratio > 1.0)
    monkeypatch.setattr(measured_rungs, "compute_database", lambda *_: pytest.fail("measured again"))
    (again,) = error_honesty.study([case])
    assert np.array_equal(again.stated, found.stated)
    other = HonestyCase(case.name, plane_cases()[1].pair, (1.0,))
    with pytest.raises(pytest.fail.Exception):
        measured_rungs.measured(other, RungOf("corrected", "draft"))
