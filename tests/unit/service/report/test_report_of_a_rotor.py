"""Verbs and pages of a scene without gears: forces of bearings by orders of the shaft."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from dynamics.orders import highest_valid_order, order_frequency
from dynamics.results import RunResult
from lineofaction.cli.commands import app
from lineofaction.report.document import write_report
from lineofaction.report.run.signals import (
    _order_amplitudes,
    signal_over_time,
    signal_spectrum,
    spectrum_window,
)
from lineofaction.report.run.view import RunView, shown_signal

ROTOR = Path(__file__).parents[4] / "examples" / "jeffcott_scene.toml"
SPEED = 3843.5 / 60.0  # turns per second


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("rotor") / "run.nc"
    told = CliRunner().invoke(app, ["simulate", str(ROTOR), "-o", str(file)])
    assert told.exit_code == 0, told.output
    return file


def test_the_spectrum_of_a_run_has_order_1(run: Path, tmp_path: Path) -> None:
    result = RunResult.from_netcdf(run)
    assert order_frequency(result) == pytest.approx(np.full(result.time.size, SPEED))
    assert highest_valid_order(result) == math.floor(1000.0 / 2.56 / SPEED)
    figure = signal_spectrum(result, shown_signal(result, RunView(scale="peak")))
    assert "shaft frequency" in figure.caption
    (line,) = figure.content[0].lines
    history = signal_over_time(result, shown_signal(result, RunView()))
    assert history.content[1].title == "three turns at 3844 rpm"
    window = order_frequency(result)[spectrum_window(result.time)]
    first, second = _order_amplitudes(line.x, line.y, window)[:2]
    assert first[1] > 1e3 * second[1]
    written = write_report(run, tmp_path / "run.html", tmp_path / "images")
    assert {file.stem for file in written} == {"run", "signal", "spectrum"}
    assert "shaft order" in written[0].read_text("utf-8")


@pytest.mark.parametrize(
    ("verb", "says"),
    [("modes", "71.18 Hz"), ("response", "force on bearing left"), ("steady", "rms bearing force of left")],
)
def test_studies_print_and_draw_bearings(verb: str, says: str, tmp_path: Path) -> None:
    file = tmp_path / f"{verb}.nc"
    told = CliRunner().invoke(app, [verb, str(ROTOR), "--speed-rpm", "3800,4000", "-o", str(file)])
    assert told.exit_code == 0, told.output
    assert says in told.output
    assert write_report(file, tmp_path / "page.html")[0].exists()
