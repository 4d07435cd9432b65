"""``loa noise --run`` and ``loa vibration --run``: bearing forces of a run, not of the linear response."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa, printed
from declared_figures import check_declared
from hulls import box
from reduced_housings import bare_housing
from scene_files import scene_file
from sounding_housings import smooth_motion, with_surface

from dynamics.results import RunResult
from lineofaction.report.drawing import surface_view

ORDERS = 4
CHEAP = "--no-boundary-elements"


def told(*arguments: object) -> Any:
    answer = printed(*arguments)
    check_declared(str(arguments[0]), answer)
    return answer


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A scene with a housing, run up, in `run.nc` beside it, and at a constant speed, in `even.nc`."""
    folder = tmp_path_factory.mktemp("runs")
    file = scene_file(folder, duration=0.6)
    bare = bare_housing(("left", "right"), motions=3, positions=[(0.0, 0.0, 0.05), (0.08, 0.0, 0.05)])
    hull = box((0.3, 0.2, 0.15), (6, 4, 3))
    with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness))).to_netcdf(folder / "case.nc")
    text = f'{file.read_text()}[[housings]]\nname = "case"\nmodes_file = "case.nc"\n'
    file.write_text(text)
    laws = {"even": ("speed_rpm=[2000.0]",), "run": ("time_s=[0.0, 0.6]", "speed_rpm=[1500.0, 3000.0]")}
    for name, law in laws.items():
        options = [word for field in law for word in ("--set", f"drives.motor.{field}")]
        result = loa("simulate", file, *options, "-o", folder / f"{name}.nc")
        assert result.exit_code == 0, result.stderr
    return file


def run_of(scene: Path, name: str = "run") -> Path:
    return scene.with_name(f"{name}.nc")


def test_levels_of_a_run_go_over_its_speeds_and_its_time(scene):
    answer = told("noise", scene, CHEAP, "--run", run_of(scene), "--orders", ORDERS)
    forces, heard = answer["forces"], answer["over_time"]
    speed = np.array(answer["speed_rpm"])
    assert np.all(np.diff(speed) > 0.0) and speed[0] > 1500.0 and speed[-1] < 3000.0
    np.testing.assert_allclose(speed, 1500.0 + 2500.0 * np.array(forces["time_s"]), rtol=1e-6)
    assert forces["source"] == "run" and forces["window_pitches"] == 16
    assert set(forces["remainder"]) == {"left", "right"}
    assert answer["equilibrium"] is None and answer["band"] is None
    assert np.array(answer["level_db"]).shape == np.array(forces["smearing"]).shape == (ORDERS, speed.size)
    np.testing.assert_allclose(heard["speed_rpm"], 1500.0 + 2500.0 * np.array(heard["time_s"]), rtol=1e-6)
    total = np.interp(heard["speed_rpm"], speed, answer["total_level_db"])
    assert np.median(np.array(heard["total_level_db"]) - total) > -0.3  # it holds more than the orders
    bands = np.sum(10.0 ** (np.array(heard["third_octave_db"]) / 10.0), axis=0)
    assert np.all(10.0 * np.log10(bands) <= np.array(heard["total_level_db"]) + 1e-6)


def test_a_housing_in_which_the_run_did_not_move_is_named(scene, tmp_path):
    run, call = RunResult.from_netcdf(run_of(scene)), ("--orders", ORDERS)
    assert told("vibration", scene, "--run", run_of(scene), *call)["forces"]["other_housings"] == []
    (part,) = run.case["housings"]
    softer = part | {"stiffness": (0.99 * np.array(part["stiffness"])).tolist()}
    for housings in ([], [softer]):
        replace(run, case=run.case | {"housings": housings}).to_netcdf(tmp_path / "other.nc")
        forces = told("vibration", scene, "--run", tmp_path / "other.nc", *call)["forces"]
        assert forces["other_housings"] == ["case"]
    printed = loa("vibration", scene, "--run", tmp_path / "other.nc", *call).stdout
    assert "housing case: not that in which the run moved" in " ".join(printed.split())


@pytest.mark.law
def test_at_constant_speed_it_is_near_the_linear_response(scene):
    """The stiffness of the table varies; the first order of a heavily loaded pair hardly knows."""
    run = told("noise", scene, CHEAP, "--run", run_of(scene, "even"), "--orders", ORDERS)
    linear = told("noise", scene, CHEAP, "--speed-rpm", 2000, "--orders", ORDERS, "--no-band")
    assert linear["forces"] == {"source": "linear response"} and linear["over_time"] is None
    settled = np.array(run["level_db"])[:, -3:]
    assert np.ptp(settled, axis=1).max() < 0.1
    assert settled[0].mean() == pytest.approx(linear["level_db"][0][0], abs=3.0)
    np.testing.assert_allclose(run["speed_rpm"], 2000.0, rtol=1e-9)


@pytest.mark.parametrize(
    ("verb", "key"), [(("noise", CHEAP), "sound_over_time"), (("vibration",), "housing_velocity")]
)
@pytest.mark.parametrize(("name", "axis"), [("run", "speed of input, rpm"), ("even", "time, s")])
def test_reports_say_whose_forces_they_are(scene, tmp_path, monkeypatch, verb, key, name, axis):
    monkeypatch.setattr(surface_view, "ACROSS", 90)
    file = tmp_path / "report.html"
    result = loa(verb[0], scene, *verb[1:], "--run", run_of(scene, name), "--orders", ORDERS, "-o", file)
    assert (result.exit_code, result.stderr) == (0, "")
    assert "forces on bearings: orders of the run" in " ".join(result.stdout.split())
    text = file.read_text("utf-8")
    for words in (key, axis, "orders of the run", "what orders do not hold"):
        assert words in text


def test_velocities_of_a_run_are_by_its_speeds(scene):
    answer = told("vibration", scene, "--run", run_of(scene), "--orders", ORDERS)
    assert answer["forces"]["source"] == "run"
    assert np.array(answer["surface_mm_per_s"]).shape == (ORDERS, len(answer["speed_rpm"]))
    assert told("vibration", scene, "--speed-rpm", 2000)["forces"] == {"source": "linear response"}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--run", "run.nc", "--speed-rpm", 2000), ("speed_rpm", "left out with a run", "own speeds")),
        (("--run", "ste.nc"), ("run = ", "a run")),
        (("--run", "none.nc"), ("run", "no such file")),
        (("--run", "run.nc", "--orders", 4, "--sensitivities"), ("sensitivities", "leave out the run")),
        (("--run", "run.nc", "--orders", 90), ("orders = 90", "outputs.mesh_orders = 90")),
    ],
)
def test_what_does_not_go_together_is_refused(scene, options, words):
    named = [scene.with_name(part) if str(part).endswith(".nc") else part for part in options]
    result = loa("noise", scene, *named)
    assert result.exit_code == 2
    for word in words:
        assert word in " ".join(result.stderr.split()), result.stderr


def test_a_run_of_other_bearings_is_refused(scene, tmp_path):
    run = RunResult.from_netcdf(run_of(scene))
    object.__setattr__(run, "bearing", ("left", "rear"))
    run.to_netcdf(tmp_path / "other.nc")
    result = loa("noise", scene, "--run", tmp_path / "other.nc", "--orders", ORDERS)
    assert result.exit_code == 2
    assert "'right'" in result.stderr and "one of left, rear" in result.stderr
