"""The page on sound power: its example runs, its closed forms are those of the library."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from wav_files import read_wav

from dynamics.acoustics import errors_db

PAGE = Path(__file__).parents[4] / "docs" / "theory" / "sound-power.md"


def test_the_examples_run(tmp_path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for script in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL):
        exec(compile(script, str(PAGE), "exec"), names)
    assert 0.0 < names["radiation"].facts.interpolation_error < 0.3
    assert "[" in capsys.readouterr().out
    assert read_wav("run-up.wav").peak == pytest.approx(names["heard"].peak)


def test_the_errors_it_states_are_those_of_the_library() -> None:
    text = " ".join(PAGE.read_text("utf-8").split())
    erp = "equivalent_radiated_power"
    assert f"At ka = 1.83 equivalent radiated power is {errors_db(1.83)[erp][0]:.1f} dB too loud" in text
    assert (
        f"at ka = 0.5 {errors_db(0.5)[erp][0]:.0f} dB for n = 0 and {errors_db(0.5)[erp][1]:.0f} dB" in text
    )
    assert f"{-errors_db(0.01)['monopoles'][1]:.1f} dB low for n = 1" in text
