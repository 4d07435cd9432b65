"""A rotor without gears is deflected and drawn, and a torque that no load takes is refused at once."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.deflect import Inputs
from lineofaction.gearbox.studies.deflect.run import RUN

ROTOR = Path(__file__).parents[4] / "examples" / "jeffcott_scene.toml"
WEIGHT = 10.0 * 9.81


def test_a_rotor_under_its_weight_hangs_in_its_bearings(tmp_path: Path) -> None:
    files = [tmp_path / f"rotor.{ending}" for ending in ("json", "png", "html")]
    for file in files:
        options = ["--set", "gravity_m_per_s2=[0.0, -9.81, 0.0]", "-o", str(file)]
        result = CliRunner().invoke(app, ["deflect", str(ROTOR), *options])
        assert (result.exit_code, result.stderr) == (0, "")
    (case,) = json.loads(files[0].read_text("utf-8"))["load_cases"]
    assert [bearing["force_n"][1] for bearing in case["bearings"]] == pytest.approx([-0.5 * WEIGHT] * 2)
    html = files[2].read_text("utf-8")
    assert "The axes move by up to 49.1 µm." in html  # half of the weight on 1e6 N/m
    assert '"y, mm"' in html and '"x, mm"' not in html  # seen as it bends


def test_the_cost_of_a_verb_is_that_of_its_process_and_children(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lineofaction.cli.study.cpu_seconds", lambda: 117.0)
    result = CliRunner().invoke(app, ["deflect", str(ROTOR)])
    assert [line for line in result.stdout.splitlines() if "CPU" in line] == ["cost 117 CPU s"]


def test_what_was_made_for_a_deflection_is_in_its_cost(tmp_path: Path) -> None:
    scene = read_model(SceneInput, ROTOR)
    tabled = TabledScene(scene, {}, dynamic_scene(scene, {}), {}, seconds=57.5)
    inputs = Inputs.model_validate({"load_cases": [{"name": "own"}]})
    assert RUN.compute(tabled, inputs, Means(tmp_path, lambda *_: None)).seconds >= 57.5


def test_a_torque_in_a_scene_without_loads_is_refused_by_its_field() -> None:
    scene = read_model(SceneInput, ROTOR)
    inputs = Inputs.model_validate({"load_cases": [{"name": "own"}, {"name": "high", "torque_n_m": 5.0}]})
    with pytest.raises(BadInput) as refused:
        RUN.check(scene, inputs)
    (fault,) = refused.value.faults
    assert (fault.field, fault.value) == ("load_cases[1].torque_n_m", 5.0)
