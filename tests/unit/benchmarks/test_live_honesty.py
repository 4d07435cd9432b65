"""The study of live answers asks what it says it asks."""

from __future__ import annotations

import numpy as np

from benchmarks import live_honesty
from benchmarks.error_honesty import Judged
from benchmarks.live_honesty import ACROSS, PROFILES, all_bodies, head, publish

VALUE = np.array([[10e-6, 20e-6], [4e-6, 5e-6], [2e-6, 3e-6]])
HELD = Judged("spur 20/20", "corrected draft", VALUE, 0.03 * VALUE, 0.01 * VALUE, "plain")
MISSED = Judged("spur 20/20", "corrected draft", VALUE, 0.004 * VALUE, 0.01 * VALUE, "long tip relief")


def test_every_pair_is_asked_once_and_without_its_own_flanks() -> None:
    found = all_bodies()
    assert len({repr((bodies.plain, bodies.options)) for bodies in found}) == len(found) >= 20
    for bodies in found:
        gears = (bodies.plain.pinion, bodies.plain.wheel)
        assert not any(gear.modification.varies_along_profile for gear in gears)
        assert not any(gear.modification.varies_along_face for gear in gears)


def test_in_the_plane_nothing_is_asked_that_acts_across_the_face() -> None:
    flat = [bodies for bodies in all_bodies() if not bodies.options]
    assert flat and all(set(bodies.questions) == set(PROFILES) for bodies in flat)
    assert all(question.misalignment == 0.0 for question in PROFILES.values())
    assert any(question.misalignment for question in ACROSS.values())


def test_the_page_counts_what_was_held(tmp_path, monkeypatch) -> None:
    page = tmp_path / "accuracy.md"
    marks = [f"<!-- {w} live honesty: written by scripts/bench --publish -->" for w in ("begin", "end")]
    page.write_text(f"before\n{marks[0]}\nstale\n{marks[1]}\nafter\n")
    monkeypatch.setattr(live_honesty, "PAGE", page)
    publish([HELD, MISSED], {"lineofaction": "1", "numpy": "2", "scipy": "3"})
    text = page.read_text()
    assert "stale" not in text and text.startswith("before\n") and text.endswith("after\n")
    assert "| all | 4 | 50 % | 1.7 | 50 % | 1.7 | 50 % | 1.7 |" in text
    assert "1 pairs" in head([HELD, MISSED]) and "4 answers" in head([HELD, MISSED])
