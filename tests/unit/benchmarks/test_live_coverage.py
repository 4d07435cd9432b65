"""The study of live answers asks what it says it asks."""

import numpy as np

from benchmarks import live_coverage
from benchmarks.assessed import Assessed
from benchmarks.live_coverage import ACROSS, PROFILES, all_bodies, head, publish

VALUE = np.array([[10e-6, 20e-6], [4e-6, 5e-6], [2e-6, 3e-6], [1e-6, 1e-6], [1e-6, 1e-6]])
COVERED = Assessed("spur: plain", "corrected plane, draft", VALUE, 0.03 * VALUE, 0.01 * VALUE)
MISSED = Assessed("spur: long tip relief", "corrected plane, draft", VALUE, 0.004 * VALUE, 0.01 * VALUE)


def test_every_pair_is_asked_once_and_without_its_own_flanks():
    found = all_bodies()
    assert len({repr((bodies.plain, bodies.options)) for bodies in found}) == len(found) >= 10
    for bodies in found:
        gears = (bodies.plain.pinion, bodies.plain.wheel)
        assert not any(gear.modification.varies_along_profile for gear in gears)
        assert not any(gear.modification.varies_along_face for gear in gears)


def test_in_the_plane_nothing_is_asked_that_acts_across_the_face():
    flat = [bodies for bodies in all_bodies() if not bodies.options]
    assert flat and all(set(bodies.questions) == set(PROFILES) for bodies in flat)
    assert all(question.misalignment == 0.0 for question in PROFILES.values())
    assert any(question.misalignment for question in ACROSS.values())


def test_the_page_counts_what_is_covered(tmp_path, monkeypatch):
    page = tmp_path / "accuracy.md"
    marks = [f"<!-- {w} live answers: written by scripts/bench --publish -->" for w in ("begin", "end")]
    page.write_text(f"before\n{marks[0]}\nstale\n{marks[1]}\nafter\n")
    monkeypatch.setattr(live_coverage, "PAGE", page)
    publish([COVERED, MISSED], {"lineofaction": "1", "numpy": "2", "scipy": "3"})
    text = page.read_text()
    assert "stale" not in text and text.startswith("before\n") and text.endswith("after\n")
    assert "| all | 4 | 50 %, 1.7 | 50 %, 1.7 | 50 %, 1.7 |" in text
    assert "2 answers of 3 loads" in head([COVERED, MISSED])
