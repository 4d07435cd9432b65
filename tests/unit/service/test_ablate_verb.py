"""``loa ablate``: table, JSON and picture of an ablation; refusals by name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from geared_scenes import gear_pair_scene
from spur_case import spur_case
from typer.testing import CliRunner

from dynamics.ablation import ablate
from lineofaction.cli.commands import app
from lineofaction.gearbox.studies.ablate.run import RUN
from lineofaction.report.drawing.image import png
from lineofaction.report.effects.ablate import _ablation_figure, _look

CASE = (
    spur_case(
        "tip_relief_um = 15.0\ntip_relief_length_mm = 1.2", "tip_relief_um = 15.0\ntip_relief_length_mm = 1.2"
    )
    + """
[load]
torque_n_m = [20.0, 100.0]
[accuracy]
level = "draft"
positions = 64
"""
)


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


def test_a_case_gives_table_json_and_picture(case: Path, tmp_path: Path) -> None:
    picture = tmp_path / "influence.png"
    only = "tooth_coupling,profile_modification,misalignment"
    run = CliRunner().invoke(app, ["ablate", str(case), "--only", only, "-o", str(picture), "--json"])
    assert run.exit_code == 0, run.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    told = json.loads(run.stdout)
    assert told["of"] == "case"
    assert told["left_out"] == {"misalignment": "the gears are aligned"}
    assert told["torque_n_m"] == pytest.approx([20.0, 100.0])
    coupling, relief = told["effects"]
    assert (coupling["name"], relief["name"]) == ("tooth_coupling", "profile_modification")
    # docs/effects.md#profile_modification: what ignoring the relief changes at 100 N m
    assert relief["relative_mean_change"][1] == pytest.approx(-0.138, abs=0.02)
    for entry in (coupling, relief):
        whole = entry["with"]["mean_um"][1]
        assert 1.0 < whole < 20.0
        assert entry["mean_change_um"][1] == pytest.approx(entry["without"]["mean_um"][1] - whole, rel=1e-9)
        assert 0.5 < entry["estimate"]["mean_um"] / entry["mean_change_um"][1] < 2.0
    text = CliRunner().invoke(app, ["ablate", str(case), "--only", only])
    assert "tooth_coupling" in text.stdout
    assert "not toggled: misalignment: the gears are aligned" in text.stdout


def test_a_scene_gives_orders_of_errors_and_bearing_forces() -> None:
    made = ablate(gear_pair_scene(duration=0.03), only=["lateral", "friction"])
    told = RUN.figures(made)
    assert told["of"] == "scene"
    (lateral,) = told["effects"]
    assert np.shape(lateral["order_change_um"]) == (1, 5)
    assert np.shape(lateral["bearing_order_change_n"]) == (4, 5)
    assert lateral["influence_um"] == pytest.approx(1e6 * made.effects[0].influence, rel=1e-12)
    figure = _ablation_figure(made)
    assert [panel.title for panel in figure.content] == ["Transmission error", "Bearing force"]
    assert [line.name for line in figure.content[0].lines] == ["as decided", "without lateral"]
    assert png(figure).startswith(b"\x89PNG")
    ((name, state, *_),) = _look(made).table(made).rows
    assert (name, state) == ("lateral", "on")


@pytest.mark.parametrize(
    ("more", "field"), [(["--only", "windage"], "only"), (["-o", "influence.gif"], "output")]
)
def test_what_cannot_be_done_is_refused_by_name(case: Path, more: list[str], field: str) -> None:
    run = CliRunner().invoke(app, ["ablate", str(case), *more])
    assert run.exit_code == 2
    assert field in run.output
