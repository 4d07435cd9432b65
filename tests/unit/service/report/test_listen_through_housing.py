"""``loa listen`` through the housings of a scene: velocity of a point, sound pressure at a microphone."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hulls import box
from reduced_housings import bare_housing
from scene_files import scene_file
from sounding_housings import smooth_motion, with_surface
from typer.testing import CliRunner, Result
from wav_files import read_wav

from dynamics.housings import ReducedHousing, scene_housing
from dynamics.housings.reduced_housing import PointMotion
from dynamics.joints import Housing
from dynamics.noise import pressure_recording, sound_limit, velocity_recording
from dynamics.results import RunResult
from dynamics.types import FloatArray
from lineofaction.cli.commands import app
from lineofaction.gearbox import workbench
from lineofaction.gearbox.studies.housings import other_housings
from lineofaction.gearbox.studies.listen.run import HeardRun

MICROPHONE = ("--microphone", "600,800,-200")


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["listen", *map(str, arguments)])


@pytest.fixture(scope="module")
def housing() -> ReducedHousing:
    bare = bare_housing(("left", "right"), motions=3, positions=[(0.0, 0.0, 0.05), (0.08, 0.0, 0.05)])
    hull = box((0.3, 0.2, 0.15), (6, 4, 3))
    sounding = with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))
    motion = np.random.default_rng(4).normal(size=(3, len(bare.stiffness)))
    return replace(sounding, points=(PointMotion("lid", np.zeros(3), motion),))


@pytest.fixture
def scene(housing: ReducedHousing, tmp_path: Path) -> Path:
    file = scene_file(tmp_path)
    housing.to_netcdf(tmp_path / "case.nc")
    file.write_text(f'{file.read_text()}[[housings]]\nname = "case"\nmodes_file = "case.nc"\n')
    return file


@pytest.fixture
def moved(run: RunResult, housing: ReducedHousing) -> RunResult:
    """The run of a scene with the housing, at constant speed: its loudness is told faster."""
    part = json.loads(json.dumps(vars(scene_housing(housing, "case")), default=list))
    speed = np.broadcast_to([[-40.0], [80.0]], run.speed.shape)
    return replace(run, speed=speed, case=run.case | {"housings": [part]})


@pytest.fixture
def file(moved: RunResult, tmp_path: Path) -> Path:
    moved.to_netcdf(tmp_path / "run.nc")
    return tmp_path / "run.nc"


def test_in_python_the_sound_needs_no_table(
    moved: RunResult, housing: ReducedHousing, scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mosqito", None)  # its figures take seconds
    monkeypatch.setattr(workbench, "scene_by_tables", None)
    heard: HeardRun = workbench.listen(scene, run=moved, microphone_mm=(600.0, 800.0, -200.0))
    expected = pressure_recording(housing, moved, np.array([0.6, 0.8, -0.2]))
    assert heard.recording.samples.tolist() == expected.samples.tolist()


@pytest.mark.law
def test_the_sound_pressure_is_that_of_the_library_with_its_limits(
    file: Path,
    moved: RunResult,
    housing: ReducedHousing,
    scene: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "mosqito", None)  # its figures take seconds
    call = (file, "-o", tmp_path / "a.wav", "--scene", scene, *MICROPHONE)
    done = loa(*call, "--json")
    assert (done.exit_code, done.stderr) == (0, "")
    facts = json.loads(done.stdout)
    (entry,) = facts["files"]
    heard, expected = read_wav(tmp_path / "a.wav"), pressure_recording(housing, moved, [0.6, 0.8, -0.2])
    np.testing.assert_allclose(heard.samples, expected.samples, atol=1e-6 * expected.peak)
    assert (heard.unit, heard.quantity) == ("Pa", expected.quantity)
    assert f"up to {sound_limit(housing):.0f} Hz" in entry["quantity"]
    assert "no room" in facts["remark"] and "7 dB too low" in facts["remark"]
    assert facts["warnings"] == []
    level = 20.0 * np.log10(entry["rms"] / 20e-6)
    assert entry["sound"]["level_db"] == pytest.approx(level, abs=1e-6)
    assert entry["sound"]["level_db_a"] < level
    printed = loa(*call).stdout
    for words in ("dB(A)", "sone", "acum", "tones, Hz", f"{entry['sound']['level_db_a']:.1f}", "no room"):
        assert words in printed


def test_two_designs_are_told_apart_in_one_call(
    moved: RunResult, file: Path, scene: Path, tmp_path: Path
) -> None:
    """Half of the force: 6.02 dB less, and files on one scale."""
    pytest.importorskip("mosqito", reason="loudness needs the extra psychoacoustics")
    replace(moved, bearing_force=0.5 * moved.bearing_force).to_netcdf(tmp_path / "after.nc")
    call = (file, tmp_path / "after.nc", "-o", tmp_path / "sounds", "--scene", scene, *MICROPHONE)
    before, after = (entry["sound"] for entry in json.loads(loa(*call, "--json").stdout)["files"])
    for name in ("level_db", "level_db_a"):
        assert before[name] - after[name] == pytest.approx(20.0 * np.log10(2.0), abs=1e-6)
    assert before["loudness_sone"] > after["loudness_sone"] > 0.0
    loud, quiet = (read_wav(tmp_path / "sounds" / f"{name}.wav") for name in ("run", "after"))
    np.testing.assert_allclose(quiet.samples, 0.5 * loud.samples, atol=1e-6 * loud.peak)


def test_a_point_is_heard_by_its_velocity(
    file: Path, moved: RunResult, housing: ReducedHousing, scene: Path, tmp_path: Path
) -> None:
    call = (file, "-o", tmp_path / "a.wav", "--scene", scene, "--point", "lid")
    for extra, axis in (((), None), (("--direction", "z"), np.array([0.0, 0.0, 1.0]))):
        done = loa(*call, *extra)
        assert done.exit_code == 0 and "loudness is that of a sound pressure alone" in done.stdout
        expected = velocity_recording(housing, moved, "lid", axis)
        heard = read_wav(tmp_path / "a.wav")
        assert (heard.unit, heard.quantity) == ("m/s", expected.quantity)
        np.testing.assert_allclose(heard.samples, expected.samples, atol=1e-6 * expected.peak)


def test_a_run_that_moved_in_no_or_another_housing_is_warned_of(
    run: RunResult, moved: RunResult, housing: ReducedHousing, scene: Path, tmp_path: Path
) -> None:
    (part,) = moved.case["housings"]
    softer = part | {"stiffness": (0.99 * np.array(part["stiffness"])).tolist()}
    for case in (run.case, run.case | {"housings": [softer]}):
        replace(run, case=case).to_netcdf(tmp_path / "run.nc")
        done = loa(
            tmp_path / "run.nc", "-o", tmp_path / "a.wav", "--scene", scene, "--point", "lid", "--json"
        )
        (warning,) = json.loads(done.stdout)["warnings"]
        assert 'did not move in housing "case"' in warning["message"]


def test_housings_are_compared_by_what_they_state(run: RunResult) -> None:
    """Matrices without damping are the same again, and not those with another mass; without mass none is."""
    unit = np.eye(10)
    damped, bare, heavy = (
        Housing("case", ("left", "right"), _rows(1e8 * unit), mass=_rows(mass * unit), **further)
        for mass, further in ((1.0, {"damping": _rows(10.0 * unit)}), (1.0, {}), (1.1, {}))
    )
    massless = Housing("case", ("left", "right"), _rows(1e8 * unit))
    part = json.loads(json.dumps(vars(bare), default=list))
    moved = replace(run, case=run.case | {"housings": [part]})
    assert other_housings([bare, massless], moved) == ()
    for other in (damped, heavy):
        assert other_housings([other], moved) == ("case",)
    assert other_housings([bare], run) == ("case",)


def _rows(matrix: FloatArray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, matrix.tolist()))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--microphone", "0,0,0"], "microphone_mm"),
        (["--microphone", "0,0,80"], "at least"),
        (["--microphone", "1,2"], "three numbers in mm"),
        (["--point", "roof"], "known: lid"),
        (["--point", "lid", "--direction", "up"], "principal"),
        (["--point", "lid", *MICROPHONE], "one of --point and --microphone"),
        ([], "one of --point and --microphone"),
        ([*MICROPHONE, "--bearing", "left"], "left out with --microphone"),
        ([*MICROPHONE, "--direction", "x"], "left out with --microphone"),
    ],
)
def test_what_cannot_be_heard_is_refused(
    options: list[str], words: str, file: Path, scene: Path, tmp_path: Path
) -> None:
    done = loa(file, "-o", tmp_path / "a.wav", "--scene", scene, *options)
    assert done.exit_code == 2
    assert words in " ".join(done.stderr.split())
    assert not (tmp_path / "a.wav").exists()


def test_a_scene_is_needed_and_one_that_sounds(file: Path, tmp_path: Path) -> None:
    done = loa(file, "-o", tmp_path / "a.wav", *MICROPHONE)
    assert done.exit_code == 2 and "--scene" in done.stderr
    bare = scene_file(tmp_path)
    done = loa(file, "-o", tmp_path / "a.wav", "--scene", bare, *MICROPHONE)
    assert done.exit_code == 2 and "at least one with a surface" in " ".join(done.stderr.split())
