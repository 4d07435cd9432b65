"""``loa steady``: what it prints and writes, and how it refuses and fails."""

from __future__ import annotations

import json
import signal
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from declared_figures import check_declared
from scene_files import scene_file
from shown_effects import check_effects_shown
from typer.testing import CliRunner, Result

from dynamics.periodic import SteadyStates, find_orbit
from lineofaction.cli.commands import app
from lineofaction.gearbox.studies.steady.run import RUN
from lineofaction.report.document import write_report


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["steady", *(str(argument) for argument in arguments)])


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    return scene_file(tmp_path)


def test_every_kind_of_output_says_the_same(scene: Path, tmp_path: Path) -> None:
    files = {ending: tmp_path / f"steady.{ending}" for ending in ("nc", "json", "png", "html")}
    for file in files.values():
        result = loa(scene, "--speed-rpm", "3000,3200", "--settling-periods", 2, "-o", file)
        assert (result.exit_code, result.stderr) == (0, "")
    assert "stable" in result.stdout and "branch completed" in result.stdout
    answer = loa(scene, "--speed-rpm", "3000,3200", "--settling-periods", 2, "--json")
    printed, found = json.loads(answer.stdout), SteadyStates.from_netcdf(files["nc"])
    written = json.loads(files["json"].read_text())
    check_declared("steady", written)
    for told in (printed, written):
        told.pop("cpu_seconds")
        assert told.pop("warnings") == []
        assert told == {k: v for k, v in RUN.figures(found).items() if k != "cpu_seconds"}
    assert [point["speed_rpm"] for point in printed["up"]] == pytest.approx([3000.0, 3200.0])
    assert [point["speed_rpm"] for point in printed["down"]] == pytest.approx([3200.0, 3000.0])
    up, down = printed["up"][0], printed["down"][1]
    assert up["status"] == "converged" and up["stability"] == "stable"
    assert np.hypot(*up["largest_multiplier"]) < 1.0
    assert up["residual_um"] < 1e-6
    assert up["meshes"]["mesh"]["rms_error_um"] == pytest.approx(
        down["meshes"]["mesh"]["rms_error_um"], rel=1e-6
    )
    assert printed["jumps"] == [] and printed["branch"]["status"] == "completed"
    width, height = struct.unpack(">II", files["png"].read_bytes()[16:24])
    assert width > 1000 and height > 1000
    check_effects_shown(written["effect_ledger"], result.stdout, files["html"].read_text("utf-8"))
    page = tmp_path / "page.html"
    write_report(files["nc"], page)
    assert "Periodic steady states over speed" in page.read_text()


def test_motions_that_are_not_found_are_printed_and_fail(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(find_orbit.__globals__, "ITERATION_LIMIT", 0)
    for form in ((), ("--json",)):
        result = loa(scene, "--speed-rpm", "3000", "--settling-periods", 0, "-o", tmp_path / "s.png", *form)
        assert result.exit_code == 1
        assert "1 of 1 motions were not found, at 3000 rpm" in result.stderr
    (point,) = json.loads(result.stdout)["up"]
    assert point["status"] == "iteration limit" and point["residual_um"] > 0.0
    assert "meshes" not in point


def test_ctrl_c_ends_a_study_without_a_file(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    @contextmanager
    def interrupting() -> Iterator[Callable[[str, float], None]]:
        def report(stage: str, _fraction: float) -> None:
            if stage == "down":
                signal.raise_signal(signal.SIGINT)

        yield report

    monkeypatch.setattr("lineofaction.cli.study.progress_bar", interrupting)
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        result = loa(scene, "--speed-rpm", "3000,3200", "--settling-periods", 2, "-o", tmp_path / "s.nc")
    finally:
        signal.signal(signal.SIGINT, handler)
    assert (result.exit_code, result.stdout) == (130, "")
    assert "interrupted" in result.stderr
    assert not (tmp_path / "s.nc").exists()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (["--speed-rpm", "0:100:50"], "speed_rpm[0]"),
        (["--speed-rpm", "a"], "--speed-rpm"),
        (["--speed-rpm", "100", "--repeat", "0"], "repeat"),
        (["--speed-rpm", "100", "--settling-periods", "-1"], "settling_periods"),
        (["--speed-rpm", "100", "-o", "x.csv"], "output"),
    ],
)
def test_bad_input_is_one_clear_error(scene: Path, arguments: list[str], field: str) -> None:
    result = loa(scene, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.strip().splitlines()
    assert line.startswith("error: ") and field in line and "must be" in line
