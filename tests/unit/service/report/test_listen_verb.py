"""``loa listen``: files of stated quantity and level, on one full scale; nothing that is none."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result
from wav_files import read_wav

from dynamics.results import RunResult
from lineofaction.cli.commands import app


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["listen", *map(str, arguments)])


@pytest.fixture
def file(run: RunResult, tmp_path: Path) -> Path:
    run.to_netcdf(tmp_path / "run.nc")
    return tmp_path / "run.nc"


def test_a_run_becomes_a_file_of_its_force_with_the_levels_of_its_orders(file: Path, tmp_path: Path) -> None:
    """10 N and 20 N at the first two mesh orders along y, on 1000 N."""
    done = loa(file, "-o", tmp_path / "a.wav", "--json")
    assert done.exit_code == 0
    facts = json.loads(done.stdout)
    (entry,) = facts["files"]
    recording = read_wav(tmp_path / "a.wav")
    assert (recording.quantity, recording.unit) == (entry["quantity"], "N")
    assert recording.quantity == (
        "force on bearing right along (0.000, 1.000, 0.000), 100 % of its variance; no sound pressure"
    )
    assert recording.peak == pytest.approx(facts["full_scale"])
    assert entry["duration_s"] == pytest.approx(2.0, abs=1e-4)
    assert entry["rms"] == pytest.approx(np.sqrt(np.mean(recording.samples**2)), rel=1e-6)
    orders = entry["loudest"]["orders_rms"]
    assert orders["1"] == pytest.approx(10.0 / np.sqrt(2.0), rel=1e-3)
    assert orders["2"] == pytest.approx(20.0 / np.sqrt(2.0), rel=1e-3)


def test_two_runs_keep_their_ratio_and_are_heard_at_the_same_bearing(
    run: RunResult, file: Path, tmp_path: Path
) -> None:
    """The second is louder at the other bearing, which is not that of the first."""
    force = 0.25 * run.bearing_force
    force[0, 0] = 100.0 * np.cos(2.0 * np.pi * 200.0 * run.time)
    replace(run, bearing_force=force).to_netcdf(tmp_path / "quiet.nc")
    done = loa(file, tmp_path / "quiet.nc", "-o", tmp_path / "sounds")
    assert done.exit_code == 0
    assert "loudness is that of a sound pressure alone" in done.stdout
    loud, quiet = (read_wav(tmp_path / "sounds" / f"{name}.wav") for name in ("run", "quiet"))
    np.testing.assert_allclose(quiet.samples, 0.25 * loud.samples, atol=1e-6 * loud.peak)


def test_along_an_axis_is_heard_that_component(run: RunResult, tmp_path: Path) -> None:
    force = run.bearing_force.copy()
    force[1, 0] = 0.5 * force[1, 1]
    replace(run, bearing_force=force).to_netcdf(tmp_path / "run.nc")
    for direction in ("x", "y", "principal"):
        assert (
            loa(tmp_path / "run.nc", "-o", tmp_path / f"{direction}.wav", "--direction", direction).exit_code
            == 0
        )
    x, y, both = (read_wav(tmp_path / f"{name}.wav").samples for name in ("x", "y", "principal"))
    np.testing.assert_allclose(x, 0.5 * y, atol=1e-5)
    np.testing.assert_allclose(both, np.hypot(0.5, 1.0) * y, atol=1e-5)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--bearing", "middle"], 'must be one of "left", "right"'),
        (["--bearing", "left"], "one that varies over the run"),
        (["--quantity", "mesh_force"], "one that varies over the run"),
        (["--direction", "up"], "principal"),
        (["--quantity", "acceleration"], "outputs.accelerations = true"),
    ],
)
def test_what_cannot_be_heard_is_refused(options: list[str], words: str, file: Path, tmp_path: Path) -> None:
    done = loa(file, "-o", tmp_path / "a.wav", *options)
    assert done.exit_code == 2
    assert words in " ".join(done.stderr.split())
    assert not (tmp_path / "a.wav").exists()


def test_a_run_without_forces_on_bearings_says_what_it_holds(run: RunResult, tmp_path: Path) -> None:
    none = np.empty((0, 3, run.time.size))
    replace(run, bearing_force=none, bearing=()).to_netcdf(tmp_path / "run.nc")
    done = loa(tmp_path / "run.nc", "-o", tmp_path / "a.wav", "--quantity", "force")
    assert done.exit_code == 2
    assert "one that the run holds" in " ".join(done.stderr.split())


def test_outputs_that_would_overwrite_each_other_are_refused(file: Path, tmp_path: Path) -> None:
    assert loa(file, file, "-o", tmp_path / "a.wav").exit_code == 2
    assert loa(file, file, "-o", tmp_path / "sounds").exit_code == 2
    assert loa(file, "-o", tmp_path / "no" / "sounds").exit_code == 2
