"""``loa compare BEFORE AFTER --scene``: the options reach the study of a change of flanks."""

import numpy as np
import pytest
from command_line import loa
from repository import EXAMPLES

from lineofaction.cli import compare, run_study
from lineofaction.gearbox.problems import EXIT_BAD_INPUT
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.studies.change.result import ALL, DesignLevels, FlankChange

SPUR, SCENE = EXAMPLES / "palermo_spur_20_20.toml", EXAMPLES / "palermo_scene.toml"


def called(*options: object) -> str:
    return loa("compare", SPUR, SPUR, "--scene", SCENE, *options).output


def test_what_is_typed_reaches_the_study(monkeypatch, tmp_path):
    seen = {}
    monkeypatch.setattr(compare, "run_study", lambda study, options: seen.update(options))
    tolerances = tmp_path / "tolerances.toml"
    tolerances.write_text("# tolerances.toml\nsamples = 16\n", encoding="utf-8")
    cases = tmp_path / "cases.toml"
    cases.write_text("[[load_cases]]\nname = 'cruise'\ntorque_n_m = 60.0\n", encoding="utf-8")
    options = {"mesh": "gears", "load-cases": cases, "requirement-db": 70, "tolerances": tolerances}
    called("--speed-rpm", "500,600", *(word for name, own in options.items() for word in (f"--{name}", own)))
    study = seen["study"]
    assert (study.mesh, study.speed_rpm, study.requirement_db) == ("gears", (500.0, 600.0), 70.0)
    assert study.tolerances.samples == 16
    assert [(own.name, own.torque_n_m) for own in study.load_cases] == [("cruise", 60.0)]
    called("--speed-rpm", "500,600")
    assert seen["study"].mesh is None


def test_one_file_is_the_flanks_after_and_three_are_refused(monkeypatch):
    seen = {}
    monkeypatch.setattr(compare, "run_study", lambda study, options: seen.update(options))
    loa("compare", SPUR, "--scene", SCENE, "--speed-rpm", "500,600")
    assert seen["study"].before is None
    assert seen["study"].after.pair.pinion.teeth == 20
    loa("compare", SPUR, SPUR, "--scene", SCENE, "--speed-rpm", "500,600")
    assert seen["study"].before == seen["study"].after
    three = loa("compare", SPUR, SPUR, SPUR, "--scene", SCENE, "--speed-rpm", "500,600")
    assert three.exit_code == EXIT_BAD_INPUT
    assert "of those after alone" in three.output


def test_speeds_are_required():
    assert "--speed-rpm 500:6000:100" in called()


def levels(*nominal: float) -> DesignLevels:
    own = np.array([nominal])
    return DesignLevels(own, np.stack([own - 1.0, own + 1.0]), np.zeros(1), np.zeros((2, *own.shape)))


@pytest.mark.parametrize("requirement", [None, 70.0])
@pytest.mark.parametrize("second", [45.0, 60.0])
def test_the_terminal_says_once_what_gets_louder(capsys, second, requirement):
    about = ("gears", "sound power", "dB(A)", "largest", (ALL, "1", "2"), np.array([80.0]), np.array([100.0]))
    pairs = (("misalignment",), np.array([[-1e-6], [1e-6]]))
    both = levels(70.0, 70.0, 50.0), levels(65.0, 64.0, second)
    run_study._show(STUDIES["change"], FlankChange(*about, *pairs, *both, requirement, {}), [], 0.0)
    lines = capsys.readouterr().out.splitlines()
    assert [line.startswith("gets louder: ") for line in lines].index(True) < 3
    assert sum("louder: " in line for line in lines) == 1
    assert sum(line.startswith("Quieter") for line in lines) == 1
