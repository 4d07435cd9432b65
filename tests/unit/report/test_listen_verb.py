"""loa listen: files of stated quantity and level, through housings too; figures of the sound pressure."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from command_line import loa, printed
from hulls import box
from reduced_housings import bare_housing
from scene_files import scene_file
from sounding_housings import smooth_motion, with_surface
from wav_files import read_wav

import lineofaction
from dynamics.acoustics import Recording, SoundFigures, loudness_over_time, sound_figures
from dynamics.acoustics.sound_quality import is_steady
from dynamics.housings import ReducedHousing, scene_housing
from dynamics.housings.reduced_housing import PointMotion
from dynamics.noise import pressure_recording, recording_estimate, sound_limit, velocity_recording
from dynamics.orders import driving_speed
from dynamics.results import RunResult
from lineofaction.gearbox import workbench
from lineofaction.gearbox.studies.listen.run import HeardRun


@pytest.fixture
def file(run, tmp_path):
    run.to_netcdf(tmp_path / "run.nc")
    return tmp_path / "run.nc"


def test_a_run_becomes_a_file_of_its_force_with_the_levels_of_its_orders(file, tmp_path):
    """10 N and 20 N at the first two mesh orders along y, on 1000 N."""
    done = loa("listen", file, "-o", tmp_path / "a.wav", "--json")
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


def test_two_runs_keep_their_ratio_and_are_heard_at_the_same_bearing(run, file, tmp_path):
    """The second is louder at the other bearing, which is not that of the first."""
    force = 0.25 * run.bearing_force
    force[0, 0] = 100.0 * np.cos(2.0 * np.pi * 200.0 * run.time)
    replace(run, bearing_force=force).to_netcdf(tmp_path / "quiet.nc")
    done = loa("listen", file, tmp_path / "quiet.nc", "-o", tmp_path / "sounds")
    assert done.exit_code == 0
    assert "loudness is that of a sound pressure alone" in done.stdout
    loud, quiet = (read_wav(tmp_path / "sounds" / f"{name}.wav") for name in ("run", "quiet"))
    np.testing.assert_allclose(quiet.samples, 0.25 * loud.samples, atol=1e-6 * loud.peak)


def test_along_an_axis_is_heard_that_component(run, tmp_path):
    force = run.bearing_force.copy()
    force[1, 0] = 0.5 * force[1, 1]
    replace(run, bearing_force=force).to_netcdf(tmp_path / "run.nc")
    for direction in ("x", "y", "principal"):
        file = tmp_path / f"{direction}.wav"
        assert loa("listen", tmp_path / "run.nc", "-o", file, "--direction", direction).exit_code == 0
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
def test_what_cannot_be_heard_is_refused(options, words, file, tmp_path):
    done = loa("listen", file, "-o", tmp_path / "a.wav", *options)
    assert done.exit_code == 2
    assert words in " ".join(done.stderr.split())
    assert not (tmp_path / "a.wav").exists()


def test_a_run_without_forces_on_bearings_says_what_it_holds(run, tmp_path):
    none = np.empty((0, 3, run.time.size))
    replace(run, bearing_force=none, bearing=()).to_netcdf(tmp_path / "run.nc")
    done = loa("listen", tmp_path / "run.nc", "-o", tmp_path / "a.wav", "--quantity", "force")
    assert done.exit_code == 2
    assert "one that the run holds" in " ".join(done.stderr.split())


def test_outputs_that_would_overwrite_each_other_are_refused(file, tmp_path):
    assert loa("listen", file, file, "-o", tmp_path / "a.wav").exit_code == 2
    assert loa("listen", file, file, "-o", tmp_path / "sounds").exit_code == 2
    assert loa("listen", file, "-o", tmp_path / "no" / "sounds").exit_code == 2


MICROPHONE = ("--microphone", "600,800,-200")


@pytest.fixture(scope="module")
def housing():
    bare = bare_housing(("left", "right"), motions=3, positions=[(0.0, 0.0, 0.05), (0.08, 0.0, 0.05)])
    hull = box((0.3, 0.2, 0.15), (6, 4, 3))
    sounding = with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))
    motion = np.random.default_rng(4).normal(size=(3, len(bare.stiffness)))
    return replace(sounding, points=(PointMotion("lid", np.zeros(3), motion),))


@pytest.fixture
def scene(housing, tmp_path):
    moved_file = scene_file(tmp_path)
    housing.to_netcdf(tmp_path / "case.nc")
    moved_file.write_text(f'{moved_file.read_text()}[[housings]]\nname = "case"\nmodes_file = "case.nc"\n')
    return moved_file


@pytest.fixture
def moved(run, housing):
    """The run of a scene with the housing, at constant speed: its loudness is told faster."""
    part = json.loads(json.dumps(vars(scene_housing(housing, "case")), default=list))
    speed = np.broadcast_to([[-40.0], [80.0]], run.speed.shape)
    return replace(run, speed=speed, case=run.case | {"housings": [part]})


@pytest.fixture
def moved_file(moved, tmp_path):
    moved.to_netcdf(tmp_path / "run.nc")
    return tmp_path / "run.nc"


def heard_at(housing: ReducedHousing, moved: RunResult) -> Recording:
    place, estimate = np.array([0.6, 0.8, -0.2]), recording_estimate(housing, moved)
    return pressure_recording(housing, moved, place, estimate=estimate)


def test_in_python_the_sound_needs_no_table(moved, housing, scene, monkeypatch):
    monkeypatch.setitem(sys.modules, "mosqito", None)  # its figures take seconds
    monkeypatch.setattr(workbench, "scene_by_tables", None)
    heard: HeardRun = lineofaction.listen(scene, run=moved, microphone_mm=(600.0, 800.0, -200.0))
    expected = heard_at(housing, moved)
    assert heard.recording.samples.tolist() == expected.samples.tolist()


@pytest.mark.law
def test_the_sound_pressure_is_that_of_the_library_with_its_limits(
    moved_file, moved, housing, scene, tmp_path, monkeypatch
):
    monkeypatch.setitem(sys.modules, "mosqito", None)  # its figures take seconds
    call = (moved_file, "-o", tmp_path / "a.wav", "--scene", scene, *MICROPHONE)
    facts = printed("listen", *call)
    (entry,) = facts["files"]
    heard, expected = read_wav(tmp_path / "a.wav"), heard_at(housing, moved)
    np.testing.assert_allclose(heard.samples, expected.samples, atol=1e-6 * expected.peak)
    assert (heard.unit, heard.quantity) == ("Pa", expected.quantity)
    assert f"up to {sound_limit(housing):.0f} Hz" in entry["quantity"]
    assert "no room" in facts["remark"] and "within 1.5 dB" in facts["remark"]
    assert facts["warnings"] == []
    level = 20.0 * np.log10(entry["rms"] / 20e-6)
    assert entry["sound"]["level_db"] == pytest.approx(level, abs=1e-6)
    assert entry["sound"]["level_db_a"] < level
    shown = loa("listen", *call).stdout
    for words in ("dB(A)", "sone", "acum", "tones, Hz", f"{entry['sound']['level_db_a']:.1f}", "no room"):
        assert words in shown


def test_two_designs_are_told_apart_in_one_call(moved, moved_file, scene, tmp_path):
    """Half of the force: 6.02 dB less, and files on one scale."""
    pytest.importorskip("mosqito", reason="loudness needs the extra psychoacoustics")
    replace(moved, bearing_force=0.5 * moved.bearing_force).to_netcdf(tmp_path / "after.nc")
    call = (moved_file, tmp_path / "after.nc", "-o", tmp_path / "sounds", "--scene", scene, *MICROPHONE)
    before, after = (entry["sound"] for entry in printed("listen", *call)["files"])
    for name in ("level_db", "level_db_a"):
        assert before[name] - after[name] == pytest.approx(20.0 * np.log10(2.0), abs=1e-6)
    assert before["loudness_sone"] > after["loudness_sone"] > 0.0
    loud, quiet = (read_wav(tmp_path / "sounds" / f"{name}.wav") for name in ("run", "after"))
    np.testing.assert_allclose(quiet.samples, 0.5 * loud.samples, atol=1e-6 * loud.peak)


def test_a_point_is_heard_by_its_velocity(moved_file, moved, housing, scene, tmp_path):
    call = (moved_file, "-o", tmp_path / "a.wav", "--scene", scene, "--point", "lid")
    for extra, axis in (((), None), (("--direction", "z"), np.array([0.0, 0.0, 1.0]))):
        done = loa("listen", *call, *extra)
        assert done.exit_code == 0 and "loudness is that of a sound pressure alone" in done.stdout
        expected = velocity_recording(housing, moved, "lid", axis)
        heard = read_wav(tmp_path / "a.wav")
        assert (heard.unit, heard.quantity) == ("m/s", expected.quantity)
        np.testing.assert_allclose(heard.samples, expected.samples, atol=1e-6 * expected.peak)


def test_a_run_that_moved_in_no_or_another_housing_is_warned_of(run, moved, housing, scene, tmp_path):
    (part,) = moved.case["housings"]
    softer = part | {"stiffness": (0.99 * np.array(part["stiffness"])).tolist()}
    for case in (run.case, run.case | {"housings": [softer]}):
        replace(run, case=case).to_netcdf(tmp_path / "run.nc")
        done = loa(
            "listen",
            tmp_path / "run.nc",
            "-o",
            tmp_path / "a.wav",
            "--scene",
            scene,
            "--point",
            "lid",
            "--json",
        )
        (warning,) = json.loads(done.stdout)["warnings"]
        assert 'did not move in housing "case"' in warning["message"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--microphone", "0,0,0"], "microphone_mm"),
        (["--microphone", "0,0,80"], "at least"),
        (["--microphone", "1,2"], "three numbers in mm"),
        (["--point", "roof"], "known: lid"),
        (["--point", "lid", "--direction", "up"], "principal"),
        (["--point", "lid", *MICROPHONE], "one of --point and --microphone"),
        ([], "no complaint with a microphone"),
        ([*MICROPHONE, "--bearing", "left"], "left out with --microphone"),
        ([*MICROPHONE, "--direction", "x"], "left out with --microphone"),
    ],
)
def test_what_cannot_be_heard_through_a_housing_is_refused(options, words, moved_file, scene, tmp_path):
    done = loa("listen", moved_file, "-o", tmp_path / "a.wav", "--scene", scene, *options)
    assert done.exit_code == 2
    assert words in " ".join(done.stderr.split())
    assert not (tmp_path / "a.wav").exists()


def test_the_microphone_of_the_complaint_hears_where_none_is_named(moved_file, scene, tmp_path):
    stated = MICROPHONE[1].split(",")
    complained = scene.with_name("complained.toml")
    text = scene.read_text("utf-8") + f"\n[complaint]\norder = 20.0\nmicrophone_mm = [{', '.join(stated)}]\n"
    complained.write_text(text, "utf-8")
    files = {}
    for file, options in ((scene, MICROPHONE), (complained, [])):
        files[file] = tmp_path / f"{file.stem}.wav"
        done = loa("listen", moved_file, "-o", files[file], "--scene", file, *options)
        assert done.exit_code == 0, done.stderr
    assert files[scene].read_bytes() == files[complained].read_bytes()


def test_a_scene_is_needed_and_one_that_sounds(moved_file, tmp_path):
    done = loa("listen", moved_file, "-o", tmp_path / "a.wav", *MICROPHONE)
    assert done.exit_code == 2 and "--scene" in done.stderr
    bare = scene_file(tmp_path)
    done = loa("listen", moved_file, "-o", tmp_path / "a.wav", "--scene", bare, *MICROPHONE)
    assert done.exit_code == 2 and "at least one with a surface" in " ".join(done.stderr.split())


RATE = 48_000
TIME = np.arange(RATE // 2) / RATE
TONE = 20e-6 * 1e3 * np.sqrt(2.0) * np.sin(2.0 * np.pi * 1000.0 * TIME)
"""60 dB at 1 kHz: 4 sone."""


def recording(samples: np.ndarray = TONE) -> Recording:
    return Recording(samples, RATE, "sound pressure", "Pa")


def figures_of(samples: Recording, run: RunResult) -> SoundFigures:
    return sound_figures(samples, steady=is_steady(driving_speed(run)))


@pytest.fixture
def steady(run):
    return replace(run, speed=np.broadcast_to([[-40.0], [80.0]], run.speed.shape))


def test_a_steady_tone_of_60_db_has_4_sone_and_is_prominent(steady):
    pytest.importorskip("mosqito", reason="loudness needs the extra psychoacoustics")
    figures = figures_of(recording(), steady)
    assert figures.steady
    assert figures.weighted_level == pytest.approx(60.0, abs=0.01)
    assert figures.loudness == pytest.approx(4.02, rel=0.05)
    assert figures.sharpness is not None and 0.5 < figures.sharpness < 1.5
    ((frequency, ratio),) = figures.tones
    assert frequency == pytest.approx(1000.0, abs=5.0) and ratio > 8.0


def test_the_loudness_of_a_run_up_is_exceeded_for_a_twentieth_of_its_time(run):
    pytest.importorskip("mosqito", reason="loudness needs the extra psychoacoustics")
    swelling = recording(TONE * np.linspace(0.0, 1.0, TONE.size) ** 2)
    figures = figures_of(swelling, run)
    loudness = loudness_over_time(swelling)[1]
    assert not figures.steady and figures.tones == ()
    assert np.mean(loudness > figures.loudness) == pytest.approx(0.05, abs=0.01)


def test_without_the_extra_the_levels_are_left(steady, monkeypatch):
    monkeypatch.setitem(sys.modules, "mosqito", None)
    figures = figures_of(recording(), steady)
    assert figures.level == pytest.approx(60.0, abs=0.01)
    assert figures.loudness is None and figures.sharpness is None
