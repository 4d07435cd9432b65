"""``loa frontier`` of a scene: table, JSON, picture and page."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from dynamics.accuracy import FidelityResult, Frontier
from lineofaction.cli.commands import app
from lineofaction.report.drawing.image import png
from lineofaction.report.drawing.page import html
from lineofaction.report.effects.frontier import _frontier_figure, _frontier_page, _frontier_table

EXAMPLE = Path(__file__).parents[3] / "examples" / "palermo_scene.toml"


@pytest.fixture
def found() -> Frontier:
    nothing = float("nan")
    rungs = (
        FidelityResult("quasi_static", "quasi-static", 0.01, "model", 0.1, 0.2, 1.0),
        FidelityResult("torsion", "torsion only", 0.2, "model", 0.05, 0.05, nothing),
        FidelityResult("1_nm", "tolerance 1 nm", 0.5, "steps", 1e-3, 1e-3, 2e-3),
        FidelityResult("0.1_nm", "tolerance 0.1 nm", 1.0, "steps", 1e-4, 1e-4, 2e-4),
    )
    return Frontier(rungs, {"in_plane": "nothing more"}, "1_nm", "1_nm", 5, 6, np.ones((1, 1)))


def test_the_picture_marks_knee_chosen_and_reference(found: Frontier) -> None:
    figure = _frontier_figure(found)
    texts = [note.text for note in figure.content[0].notes]
    assert texts == ["quasi static", "torsion", "1 nm (knee, chosen)", "0.1 nm (reference)"]
    assert [note.text for note in figure.content[2].notes] == [t for t in texts if t != "torsion"]
    assert png(figure).startswith(b"\x89PNG")


def test_the_page_says_what_was_not_run_and_leaves_unknown_errors_out(found: Frontier) -> None:
    assert "nothing more" in html(_frontier_page(found), {"run_frontier": b""})
    assert _frontier_table(found).rows[1][4] == ""


def test_the_verb_finds_a_scene_and_writes_what_it_prints(tmp_path: Path) -> None:
    scene, case = (EXAMPLE.with_name(f"palermo_{name}.toml").read_text() for name in ("scene", "spur_20_20"))
    short = scene.replace("duration_s = 5.0", "duration_s = 0.3").replace("[0.0, 955.0]", "[600.0, 955.0]")
    (tmp_path / "scene.toml").write_text(short)
    (tmp_path / "palermo_spur_20_20.toml").write_text(case.replace("tolerance = 0.01", 'level = "draft"'))
    output = tmp_path / "ladder.json"
    rungs = "quasi_static,10_nm,1_nm,0.1_nm"
    done = CliRunner().invoke(
        app, ["frontier", str(tmp_path / "scene.toml"), "-o", str(output), "--rungs", rungs, "--json"]
    )
    assert done.exit_code == 0, done.output
    printed = json.loads(done.stdout)
    assert printed.pop("written") == [str(output)]
    assert printed == json.loads(output.read_text(encoding="utf-8"))
    assert printed["chosen"] == "1_nm"
    assert printed["reference"] == "0.1_nm"


def test_unknown_rungs_are_said_by_name(tmp_path: Path) -> None:
    done = CliRunner().invoke(
        app, ["frontier", str(EXAMPLE), "--rungs", "2_nm", "-o", str(tmp_path / "x.json")]
    )
    assert done.exit_code == 2
    assert "rungs" in done.stderr
