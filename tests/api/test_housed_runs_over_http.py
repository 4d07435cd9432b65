"""What runs do to housings over HTTP: the figures of the command line, to the last bit."""

import json
import shutil
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from housing_solid import housed_scene, write_block
from scipy.io import wavfile
from study_service import empty_service, without
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import BadInput, NotFound
from service.store.places import stored_results

TABLE, ABSENT = "cd" * 32, "ef" * 32
COSTS = ("cpu_seconds", "models_cpu_seconds", "reduction_cost", "radiation_cost", "models_predicted")
OWN = (*COSTS, "hash", "sha256", "size", "written", "file")
"""What differs between two computations of the same."""


@dataclass(frozen=True)
class Moved:
    """A service that holds a run, the scene there, the same on disk, and the run there."""

    client: LineOfActionClient
    scene: Path
    here: Path
    key: str
    run: Path

    def printed(self, verb: str, *options: object) -> dict[str, Any]:
        done = CliRunner().invoke(app, [verb, str(self.here), *map(str, options), "--json"])
        assert done.exit_code == 0, done.stderr
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer

    def refused(self, process: str, **options: Any) -> str:
        """Return what is said of inputs that are refused before there is a job."""
        with pytest.raises(BadInput) as caught:
            getattr(self.client, process).submit(self.scene, **options)
        return str(caught.value)


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("moved")
    write_block(folder / "block.step")
    scene = housed_scene(folder)
    scene["run"]["duration_s"] = 0.2
    scene["drives"][0] |= {"time_s": [0.0], "speed_rpm": [6000.0]}
    (folder / "here.json").write_text(json.dumps(scene))
    mesh = scene["meshes"][0]
    del mesh["database_file"]
    mesh["database_hash"] = TABLE
    (folder / "scene.json").write_text(json.dumps(scene))
    data = folder / "data"
    with empty_service(data) as (client, _), pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        stored_results(data).put(TABLE, "database", Path(shutil.copy(folder / "mesh.nc", folder / "put.nc")))
        job = client.simulate.submit(folder / "scene.json")
        yield Moved(client, folder / "scene.json", folder / "here.json", job.wait().key, job.file())


@pytest.mark.parametrize(
    ("name", "inputs", "options"),
    [("noise", {"boundary_elements": False}, ("--no-boundary-elements",)), ("vibration", {}, ())],
)
def test_levels_and_velocities_of_a_run_are_those_of_the_command_line(moved, name, inputs, options):
    figures = getattr(moved.client, name).submit(moved.scene, run=moved.key, orders=2, **inputs).figures()
    printed = moved.printed(name, "--run", moved.run, "--orders", 2, *options)
    served = json.loads(figures.model_dump_json(by_alias=True, exclude_unset=True))
    assert printed["forces"]["source"] == "run"
    assert without(OWN, served) == without(OWN, printed)


def test_a_run_is_part_of_the_address_of_a_result(moved):
    of_run = moved.client.vibration.submit(moved.scene, run=moved.key, orders=2).wait()
    linear = moved.client.vibration.submit(moved.scene, speed_rpm=[1500.0], orders=2).wait()
    assert of_run.key != linear.key


def heard(moved: Moved, *options: object) -> tuple[dict[str, Any], Path]:
    """Return what `loa listen` prints of the run, and the file it writes."""
    file = moved.here.with_name("heard.wav")
    call = [str(moved.run), "-o", str(file), "--scene", str(moved.here), *map(str, options), "--json"]
    done = CliRunner().invoke(app, ["listen", *call])
    assert done.exit_code == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer, file


def test_a_microphone_hears_over_http_what_it_hears_by_the_command_line(moved):
    """Figures and file, to the last bit; steady, so that there are tones."""
    job = moved.client.listen.submit(moved.scene, run=moved.key, microphone_mm=[40, 60, 400])
    served = json.loads(job.figures().model_dump_json(by_alias=True, exclude_unset=True))
    printed, file = heard(moved, "--microphone", "40,60,400")
    (entry,) = printed["files"]
    assert {name: served[name] for name in entry if name != "file"} == without(("file",), entry)
    assert served["sound"]["steady"] and "up to" in served["quantity"]
    assert served["sound"]["loudness_sone"] is None or served["sound"]["tones"]  # without the extra: None
    for name in ("full_scale", "remark", "warnings"):
        assert served[name] == printed[name]
    assert (served["run"], served["other_housings"]) == (moved.key, [])
    assert moved.client.sound(job.wait().key) == file.read_bytes()
    recording = job.result().recording
    assert (recording.unit, recording.peak) == ("Pa", served["full_scale"])


def test_a_point_is_heard_along_its_direction(moved):
    for option, direction in (((), None), (("--direction", "z"), "z")):
        job = moved.client.listen.submit(moved.scene, run=moved.key, point="cover", direction=direction)
        printed, file = heard(moved, "--point", "cover", *option)
        figures = job.figures()
        assert (figures.quantity, figures.remark) == (printed["files"][0]["quantity"], printed["remark"])
        assert figures.sound is None
        assert moved.client.sound(job.wait().key) == file.read_bytes()


def test_two_recordings_are_on_one_full_scale(moved):
    """Sample 1 is the peak of the louder one in both files."""
    near, far = (
        moved.client.listen.submit(moved.scene, run=moved.key, microphone_mm=[40, 60, z]) for z in (400, 4000)
    )
    peaks = []
    for one, other in ((near, far), (far, near)):
        wav = moved.client.sound(one.wait().key, against=other.wait().key)
        peaks.append(np.abs(wavfile.read(BytesIO(wav))[1]).max())
    expected = far.figures().full_scale / near.figures().full_scale
    np.testing.assert_allclose(peaks, [1.0, expected], rtol=1e-6)
    assert expected < 0.3


def test_a_run_that_moved_in_another_housing_is_named(moved):
    """The housing of the scene is of another material than that of the run."""
    scene = json.loads(moved.scene.read_text())
    scene["housings"][0]["material"] = "cast_aluminum"
    other = moved.scene.with_name("other.json")
    other.write_text(json.dumps(scene))
    job = moved.client.listen.submit(other, run=moved.key, point="cover")
    figures = job.figures()
    said = f'run {moved.key}: it did not move in housing "case" as the scene has it'
    assert figures.other_housings == ["case"] and said in figures.remark
    assert [warning["check"] for warning in figures.warnings] == ["other_housing"]
    assert any(said in alarm for alarm in moved.client.report(job.wait().key).alarms)


def test_the_report_of_a_recording_is_its_level_over_the_run_with_a_player(moved):
    job = moved.client.listen.submit(moved.scene, run=moved.key, microphone_mm=[40, 60, 1000])
    report = moved.client.report(job.wait().key)
    level = job.figures().sound.level_db_a
    assert f"{level:.1f} dB(A)" in [headline["value"] for headline in report.headlines]
    (figure,) = (figure for section in report.sections for figure in section["figures"])
    (trace,) = figure["plot"]["data"]
    mean = 10.0 * np.log10(np.mean(10.0 ** (np.array(trace["y"]) / 10.0)))
    assert mean == pytest.approx(level, abs=0.3)  # blocks spread what is tonal
    (track,) = figure["sound"]["tracks"]
    assert track["query"] == {} and track["time"][-1] == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize(
    ("process", "options", "words"),
    [
        ("noise", {"run": ABSENT}, ("run = ", "a stored run", "simulate")),
        ("noise", {"run": TABLE}, ("run = ", "a stored run")),
        ("vibration", {"run": "run.nc"}, ("run", "run.nc", "[0-9a-f]{64}")),
        ("vibration", {}, ("speed_rpm", "at least one speed")),
        ("noise", {"run": ABSENT, "speed_rpm": [500.0]}, ("speed_rpm", "left out with a run")),
        ("listen", {"run": ABSENT, "point": "cover"}, ("run = ", "a stored run", "simulate")),
        ("listen", {"run": ABSENT}, ("run",)),
        (
            "listen",
            {"run": ABSENT, "point": "cover", "microphone_mm": [0, 0, 1]},
            ("microphone_mm", "one of both"),
        ),
        ("listen", {"run": ABSENT, "microphone_mm": [0, 0]}, ("microphone_mm",)),
        ("listen", {"run": ABSENT, "microphone_mm": [0, 0, 1], "direction": "x"}, ("direction", "left out")),
        ("listen", {"microphone_mm": [0, 0, 1]}, ("run",)),
        ("noise", {"run": None, "sensitivities": True, "speed_rpm": []}, ("speed_rpm", "300, 600")),
    ],
)
def test_what_names_no_run_is_refused_at_the_request(moved, process, options, words):
    said = moved.refused(process, **options)
    for word in words:
        assert word in said, said


def test_what_cannot_be_heard_is_refused(moved):
    """A point that no housing has at the request; a microphone in the wall by its job."""
    assert "known: cover" in moved.refused("listen", run=moved.key, point="roof")
    job = moved.client.listen.submit(moved.scene, run=moved.key, microphone_mm=[40, 0, 110])
    with pytest.raises(BadInput) as caught:
        job.wait()
    (fault,) = caught.value.faults
    assert fault.field == "microphone_mm" and "mm" in str(caught.value)
    answer = moved.client.listen.submit(moved.scene, run=moved.key, point="cover").wait()
    with pytest.raises(BadInput, match="left out of a recording"):
        moved.client.sound(answer.key, bearing="input left")
    with pytest.raises(NotFound, match="no run and no recording"):
        moved.client.sound(TABLE)


def test_sensitivities_of_a_run_are_refused_at_the_request(moved):
    assert "left out with a run" in moved.refused("noise", run=moved.key, sensitivities=True)
