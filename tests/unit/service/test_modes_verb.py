"""``loa modes``: what it prints and writes, and how it refuses."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from declared_figures import check_declared
from scene_files import scene_file
from shown_effects import check_effects_shown
from typer.testing import CliRunner, Result

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ModalAnalysis, modal_analysis
from fe_contact.ste import SteDatabase
from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.input_file import number_list
from lineofaction.gearbox.problems import EXIT_FAILED, BadInput
from lineofaction.gearbox.studies.modes.run import RUN
from lineofaction.gearbox.subjects import scene_of
from lineofaction.report.document import write_report


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["modes", *(str(argument) for argument in arguments)])


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    return scene_file(tmp_path)


def test_json_holds_the_modes_of_python_and_nothing_else(scene: Path) -> None:
    result = loa(scene, "--speed-rpm", "0:9000:1500", "--orders", 3, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    answer = json.loads(result.stdout)
    check_declared("modes", answer)
    given, _ = scene_of(scene)
    system = assemble(dynamic_scene(given, {"mesh": SteDatabase.from_netcdf(scene.parent / "ste.nc")}))
    here = modal_analysis(system).natural_frequency
    assert [mode["frequency_hz"] for mode in answer["at_rest"]] == here.tolist()
    assert answer["at_rest"][-1]["kind"] == "torsional-lateral on mesh"
    assert answer["speed_rpm"] == pytest.approx([0, 1500, 3000, 4500, 6000, 7500, 9000])
    assert answer["mesh_frequency_hz"]["mesh"] == pytest.approx(
        [20 / 60 * rpm for rpm in answer["speed_rpm"]]
    )
    for crossing in answer["critical_speeds"]:
        excited = crossing["order"] * 20 / 60 * crossing["speed_rpm"]
        assert crossing["frequency_hz"] == pytest.approx(excited, rel=1e-8)
    assert {crossing["order"] for crossing in answer["critical_speeds"]} == {1, 2, 3}
    assert answer["equilibrium"]["status"] == "converged"
    assert sum(answer["cpu_seconds"].values()) > 0.0


def test_the_table_and_every_kind_of_file_say_the_same(scene: Path, tmp_path: Path) -> None:
    files = {ending: tmp_path / f"modes.{ending}" for ending in ("nc", "json", "png", "html")}
    for file in files.values():
        result = loa(scene, "--speed-rpm", "0:6000:3000", "-o", file)
        assert result.exit_code == 0, result.stderr
        assert "torsional-lateral on mesh" in result.stdout and str(file) in result.stdout
    found = ModalAnalysis.from_netcdf(files["nc"])
    written = json.loads(files["json"].read_text())
    written.pop("cpu_seconds")
    assert written.pop("warnings") == []
    assert written == {k: v for k, v in RUN.figures(found).items() if k != "cpu_seconds"}
    width, height = struct.unpack(">II", files["png"].read_bytes()[16:24])
    assert width > 1000 and height > 400
    assert "Campbell diagram: whirl modes over speed" in files["html"].read_text()
    check_effects_shown(written["effect_ledger"], result.stdout, files["html"].read_text("utf-8"))
    page = tmp_path / "page.html"
    write_report(files["nc"], page)
    assert "Critical speeds" in page.read_text()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (["--speed-rpm", "x"], "--speed-rpm"),
        (["--speed-rpm", "0:1"], "--speed-rpm"),
        (["--speed-rpm", "10:1:1"], "--speed-rpm"),
        (["--speed-rpm", "0:1:-1"], "--speed-rpm"),
        (["--speed-rpm", "0:1e6:1"], "--speed-rpm"),
        (["--speed-rpm", "3,2"], "speed_rpm"),
        (["--speed-rpm", "-5"], "speed_rpm"),
        (["--orders", "0"], "orders"),
        (["-o", "modes.txt"], "output"),
    ],
)
def test_bad_input_is_one_clear_error(scene: Path, arguments: list[str], field: str) -> None:
    result = loa(scene, *arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    (line,) = result.stderr.strip().splitlines()
    assert line.startswith("error: ") and field in line and "must be" in line


def test_a_load_that_parts_the_flanks_is_refused_by_name(scene: Path) -> None:
    scene.write_text(scene.read_text().replace("torque_n_m = [100.0]", "torque_n_m = [-100.0]"))
    result = loa(scene, "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "meshes[0]" in result.stderr and "driving flank" in result.stderr


def test_ranges_hold_their_last_speed() -> None:
    assert number_list("--speed-rpm", "0:1:0.1") == pytest.approx(np.linspace(0.0, 1.0, 11))
    assert number_list("--speed-rpm", "100:300:150") == [100.0, 250.0]
    assert number_list("--speed-rpm", "7:7:1") == [7.0]
    with pytest.raises(BadInput):
        number_list("--speed-rpm", "0:nan:1")


def test_a_load_far_beyond_the_table_ends_the_study_or_is_told(scene: Path) -> None:
    heavy = scene.read_text(encoding="utf-8").replace("torque_n_m = [100.0]", "torque_n_m = [100000.0]")
    assert "100000.0" in heavy
    scene.write_text(heavy, encoding="utf-8")
    result = loa(scene)
    assert result.exit_code == EXIT_FAILED
    assert "the table's highest load" in " ".join(result.stderr.split())
    scene.write_text(heavy.replace("[run]", '[run]\non_violation = "report"'), encoding="utf-8")
    result = loa(scene)
    assert result.exit_code == 0, result.stderr
    assert "VIOLATED: force inside the table" in result.stdout
