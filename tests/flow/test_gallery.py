"""Scripts of the gallery: each draws one figure of a finished result, and prints an answer, in 25 lines."""

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "gallery"
SCRIPTS = sorted(FOLDER.glob("*.py"))


def test_every_result_is_drawn():
    texts = "".join(script.read_text("utf-8") for script in SCRIPTS)
    assert len(SCRIPTS) >= 8
    assert [result.name for result in (FOLDER / "results").iterdir() if result.name not in texts] == []


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_draws_one_figure_and_prints_its_answer(script, monkeypatch, capsys):
    assert len(script.read_text("utf-8").splitlines()) <= 25
    monkeypatch.chdir(FOLDER)
    plt.switch_backend("Agg")
    plt.close("all")
    runpy.run_path(str(script), run_name="__main__")
    assert len(plt.get_fignums()) == 1
    assert capsys.readouterr().out.strip()
    plt.close("all")
