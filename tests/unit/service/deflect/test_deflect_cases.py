"""Load cases of ``loa deflect``: units, forces of the scene, refusals by field."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scene_files import scene_file
from typer.testing import CliRunner, Result

from lineofaction.cli.commands import app
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.deflect import Inputs
from lineofaction.gearbox.studies.deflect.run import RUN, load_cases


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["deflect", *(str(argument) for argument in arguments)])


def test_load_cases_come_from_their_file_in_its_units(tmp_path: Path) -> None:
    file = tmp_path / "cases.toml"
    file.write_text('[[load_cases]]\nname = "a"\nspeed_rpm = 600.0\ntorque_n_m = 20.0\ndirection = "coast"\n')
    (case,) = load_cases(read_model(Inputs, file))
    assert case.speed == pytest.approx(20.0 * np.pi) and (case.torque, case.direction) == (20.0, "coast")
    answer = json.loads(loa(scene_file(tmp_path), file, "--json").stdout)["load_cases"][0]
    assert (answer["torque_n_m"], answer["speed_rpm"]) == (pytest.approx(20.0), pytest.approx(600.0))


@pytest.mark.parametrize(
    ("line", "field"),
    [
        ("torque_n_m = -1.0", "load_cases[0].torque_n_m"),
        ('direction = "up"', "load_cases[0].direction"),
        ("torque_n_m = 1.0\nfactor = 2.0", "load_cases[0].factor"),
        ('forces = [{name = "belt", factor = 2.0}]', "load_cases[0].forces[0].name"),
        (
            'forces = [{name = "a", factor = 2.0, moment_n_m = [0.0, 0.0, 1.0]}]',
            "load_cases[0].forces[0].factor",
        ),
        ('forces = [{name = "a"}]', "load_cases[0].forces[0].force_n"),
        ('forces = [{name = "a", force_n = [1.0, 2.0]}]', "load_cases[0].forces[0].force_n"),
    ],
)
def test_a_case_that_cannot_be_is_refused_by_its_field(tmp_path: Path, line: str, field: str) -> None:
    file = tmp_path / "cases.toml"
    file.write_text(f'[[load_cases]]\nname = "a"\n{line}\n')
    result = loa(scene_file(tmp_path), file)
    assert result.exit_code == 2 and field in result.stderr


BELT = '[[forces]]\nname = "belt"\nshaft = "input"\nposition_mm = 50.0\nforce_n = [0.0, 100.0, 0.0]\n'
PULLED = """
[[load_cases]]
name = "as in the scene"
[[load_cases]]
name = "its own"
forces = [{name = "belt", force_n = [0.0, -300.0, 50.0]}]
[[load_cases]]
name = "doubled"
forces = [{name = "belt", factor = 2.0}]
[[load_cases]]
name = "coast"
direction = "coast"
forces = [{name = "belt", factor = 2.0}]
[[load_cases]]
name = "coast as in the scene"
direction = "coast"
"""


def test_a_case_states_forces_of_the_scene(tmp_path: Path) -> None:
    scene, file = scene_file(tmp_path), tmp_path / "cases.toml"
    scene.write_text(scene.read_text("utf-8") + BELT, encoding="utf-8")
    file.write_text(PULLED)
    cases = json.loads(loa(scene, file, "--json").stdout)["load_cases"]
    across = [np.array(case["bearings"][0]["force_n"][:2]) for case in cases]
    assert cases[1]["forces"] == [
        {"name": "belt", "shaft": "input", "force_n": [0.0, -300.0, 50.0], "moment_n_m": [0.0, 0.0, 0.0]}
    ]
    assert [case["forces"][0]["force_n"][1] for case in cases] == [100.0, -300.0, 200.0, 200.0, 100.0]
    assert across[1] - across[0] == pytest.approx([0.0, -400.0], rel=1e-9, abs=1e-6)
    assert across[2] - across[0] == pytest.approx([0.0, 100.0], rel=1e-9, abs=1e-6)
    assert across[3] - across[4] == pytest.approx([0.0, 100.0], rel=1e-9, abs=1e-6)


def test_forces_that_the_scene_has_not_are_refused_before_its_tables_are_computed(tmp_path: Path) -> None:
    scene = read_model(SceneInput, scene_file(tmp_path))
    cases = [{"name": "a", "forces": [{"name": "belt", "factor": 2.0}]}]
    with pytest.raises(BadInput, match=r"load_cases\[0\]\.forces\[0\]\.name"):
        RUN.check(scene, validated(Inputs, {"load_cases": cases}))


def test_a_case_without_forces_keeps_the_address_of_its_result() -> None:
    """Results are stored by what is written of their inputs."""
    (case,) = validated(Inputs, {"load_cases": [{"name": "a"}]}).model_dump(mode="json")["load_cases"]
    assert set(case) == {"name", "share", "factor", "torque_n_m", "speed_rpm", "direction"}


def test_a_force_of_a_scene_says_what_acts(tmp_path: Path) -> None:
    scene = scene_file(tmp_path)
    scene.write_text(scene.read_text("utf-8") + BELT.rpartition("force_n")[0], encoding="utf-8")
    result = loa(scene)
    assert result.exit_code == 2 and "forces[0].force_n" in result.stderr
