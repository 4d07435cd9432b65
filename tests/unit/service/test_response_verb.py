"""``loa response``: what it prints and writes, and how it refuses."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from declared_figures import check_declared
from scene_files import scene_file
from shown_effects import check_effects_shown
from typer.testing import CliRunner, Result

from dynamics.linearize import ForcedResponse, peaks
from lineofaction.cli.commands import app
from lineofaction.gearbox.studies.response.run import RUN
from lineofaction.report.document import write_report


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["response", *(str(argument) for argument in arguments)])


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    return scene_file(tmp_path)


def test_json_holds_amplitudes_by_order_and_speed_and_the_peaks(scene: Path) -> None:
    result = loa(scene, "--speed-rpm", "100:6000:50", "--orders", 4, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    answer = json.loads(result.stdout)
    check_declared("response", answer)
    assert answer["order"] == [1.0, 2.0, 3.0, 4.0]
    mesh = answer["meshes"]["mesh"]
    force = np.array(mesh["mesh_force_n"])
    assert force.shape == (4, len(answer["speed_rpm"])) == (4, 119)
    # at a crawl the flanks follow the static error
    np.testing.assert_allclose(
        np.array(mesh["dynamic_transmission_error_um"])[:, 0], mesh["static_transmission_error_um"], rtol=0.02
    )
    for peak in answer["peaks"]:
        speed = answer["speed_rpm"].index(peak["speed_rpm"])
        assert peak["frequency_hz"] == pytest.approx(peak["order"] * 20 / 60 * peak["speed_rpm"])
        part = mesh["mesh_force_n"] if peak["name"] == "mesh" else answer["bearings"][peak["name"]]["force_n"]
        values = part[answer["order"].index(peak["order"])]
        assert peak["amplitude_n"] == values[speed] > max(values[speed - 1], values[speed + 1])
    largest = answer["peaks"][0]
    assert largest["quantity"] == "mesh_force"
    # the nearest mode is met within the step of the speeds
    assert largest["frequency_hz"] == pytest.approx(largest["natural_frequency_hz"], rel=0.03)
    assert answer["residual"] < 1e-9 and answer["parting_rpm"] == []


def test_the_table_and_every_kind_of_file_say_the_same(scene: Path, tmp_path: Path) -> None:
    files = {ending: tmp_path / f"response.{ending}" for ending in ("nc", "json", "png", "html")}
    for file in files.values():
        result = loa(scene, "--speed-rpm", "2000:6000:100", "--orders", 3, "-o", file)
        assert result.exit_code == 0, result.stderr
    found = ForcedResponse.from_netcdf(files["nc"])
    shown = next(peak for peak in peaks(found))
    assert f"{shown.speed * 30 / np.pi:.1f}"[:5] in result.stdout
    assert "first-order theory" in result.stdout and str(files["html"]) in result.stdout
    written = json.loads(files["json"].read_text())
    written.pop("cpu_seconds")
    assert written.pop("warnings") == []
    assert written == {k: v for k, v in RUN.figures(found).items() if k != "cpu_seconds"}
    width, height = struct.unpack(">II", files["png"].read_bytes()[16:24])
    assert width > 1000 and height > 1000
    check_effects_shown(written["effect_ledger"], result.stdout, files["html"].read_text("utf-8"))
    page = tmp_path / "page.html"
    write_report(files["nc"], page)
    assert "Forced response to transmission errors and loads" in page.read_text()
    assert "Power lost by the vibration" in page.read_text()
    older = replace(found, power_source=(), power_sink=(), power_sink_kind=(), power_loss=np.empty((0, 0, 0)))
    replace(older, power_input=np.empty((0, 0, 0))).to_netcdf(files["nc"])
    write_report(files["nc"], page)
    assert "Power lost" not in page.read_text()


def test_the_power_of_the_vibration_is_lost_where_the_table_says(scene: Path) -> None:
    arguments = (scene, "--speed-rpm", "2000:6000:500", "--orders", 3)
    power = json.loads(loa(*arguments, "--json").stdout)["power"]
    lost = np.sum([part["loss_w"] for part in power["losses"]], axis=0)
    assert lost.shape == (3, 9)
    np.testing.assert_allclose(lost, np.sum(list(power["input_w"].values()), axis=0), rtol=1e-9, atol=1e-12)
    assert power["residual"] < 1e-9
    worst = int(np.argmax(lost.sum(axis=0)))
    lines = loa(*arguments).stdout.splitlines()
    assert f"Power lost at {2000 + 500 * worst} rpm" in " ".join(line.strip() for line in lines)
    shares = {part["kind"]: 0.0 for part in power["losses"]}
    for part in power["losses"]:
        shares[part["kind"]] += float(np.sum(part["loss_w"], axis=0)[worst] / lost.sum(axis=0)[worst])
    table = lines[next(index for index, line in enumerate(lines) if "lost in" in line) :]
    row = next(line for line in table if line.strip().startswith("mesh "))
    assert float(row.split()[-1]) == pytest.approx(100.0 * shares["mesh"], rel=0.01)


def test_speeds_at_which_flanks_part_are_said(scene: Path) -> None:
    scene.write_text(scene.read_text().replace("damping_ratio = 0.08", "damping_ratio = 0.005"))
    result = loa(scene, "--speed-rpm", "13500:14500:50", "--json")
    parting = json.loads(result.stdout)["parting_rpm"]
    assert parting and min(parting) > 13500
    shown = loa(scene, "--speed-rpm", "13500:14500:50")
    assert f"flanks lift off at {len(parting)} of 21 speeds" in shown.stdout


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (["--speed-rpm", "0:100:50"], "speed_rpm[0]"),
        (["--speed-rpm", "1:x"], "--speed-rpm"),
        (["--speed-rpm", "100", "--orders", "500"], "orders"),
        (["--speed-rpm", "100", "-o", "x.csv"], "output"),
    ],
)
def test_bad_input_is_one_clear_error(scene: Path, arguments: list[str], field: str) -> None:
    result = loa(scene, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.strip().splitlines()
    assert line.startswith("error: ") and field in line and "must be" in line


def test_trains_that_torques_alone_move_are_refused_by_name(scene: Path) -> None:
    text = scene.read_text().replace("[[drives]]", "[[free_rotations]]")
    scene.write_text(text.replace("speed_rpm = [900.0]", "initial_speed_rpm = 900.0"))
    result = loa(scene, "--speed-rpm", "100")
    assert result.exit_code == 2
    assert "free_rotations" in result.stderr
