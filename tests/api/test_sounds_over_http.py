"""Sounds of stored runs over HTTP: those of `loa listen`, on one full scale, of runs alone."""

import importlib.util
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient
from small_table import small_table
from wav_files import read_wav

from dynamics.acoustics import Recording
from service.app import create_app
from service.settings import Settings

CLOSED_FORMS = Path(__file__).parents[1] / "unit" / "report" / "conftest.py"
LOUD, QUIET, TABLE = ("a" * 64, "b" * 64, "c" * 64)


@dataclass(frozen=True)
class Stored:
    """A service with two runs and a table."""

    http: TestClient
    folder: Path

    def heard(self, key: str, **query: str) -> Recording:
        answer = self.http.get(f"/v1/results/{key}/sound", params=query)
        assert answer.status_code == 200, answer.text
        assert answer.headers["content-type"] == "audio/wav"
        (self.folder / "heard.wav").write_bytes(answer.content)
        return read_wav(self.folder / "heard.wav")


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    spec = importlib.util.spec_from_file_location("closed_forms", CLOSED_FORMS)
    assert spec and spec.loader
    forms = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(forms)
    folder = tmp_path_factory.mktemp("service")
    app = create_app(Settings(data_directory=folder / "data"))
    run = forms.run_up()
    run.to_netcdf(folder / "loud.nc")
    replace(run, bearing_force=0.25 * run.bearing_force).to_netcdf(folder / "quiet.nc")
    small_table().to_netcdf(folder / "table.nc")
    with TestClient(app) as http:
        for key, kind, name in ((LOUD, "run", "loud"), (QUIET, "run", "quiet"), (TABLE, "database", "table")):
            app.state.context.store.put(key, kind, folder / f"{name}.nc")
        yield Stored(http, folder)


def test_a_run_is_heard_at_its_level(stored):
    """10 N and 20 N at two orders: no more than 30 N together."""
    heard = stored.heard(LOUD)
    assert heard.quantity.startswith("force on bearing right along (0.000, 1.000, 0.000)")
    assert heard.unit == "N"
    assert 20.0 < heard.peak < 30.0
    assert heard.samples.size == pytest.approx(2.0 * heard.sample_rate, abs=2)


def test_two_runs_are_on_one_full_scale(stored):
    files = [
        stored.http.get(f"/v1/results/{key}/sound", params={"bearing": "right", "against": other}).content
        for key, other in ((LOUD, QUIET), (QUIET, LOUD))
    ]
    loud, quiet = (np.frombuffer(file[file.index(b"data") + 8 :][:383_000], np.float32) for file in files)
    assert np.abs(loud).max() == pytest.approx(1.0)
    np.testing.assert_allclose(quiet, 0.25 * loud, atol=1e-6)


def test_the_report_names_the_sound_as_the_path_takes_it(stored):
    report = stored.http.get(f"/v1/results/{LOUD}/figures").json()
    figures = {figure["key"]: figure for section in report["sections"] for figure in section["figures"]}
    sound = figures["order_map"]["sound"]
    assert "no sound pressure" in sound["caption"]
    (track,) = sound["tracks"]
    assert stored.heard(LOUD, **track["query"]).peak == stored.heard(LOUD).peak
    np.testing.assert_allclose(track["along"], 450.0 * np.array(track["time"]), atol=1e-3)
    np.testing.assert_allclose(track["mesh_hz"], 20 / 60 * np.array(track["along"]), atol=1e-3)  # 20 teeth
    assert figures["levels"]["sound"] is None


def test_it_is_sent_once_to_who_has_it(stored):
    path = f"/v1/results/{LOUD}/sound"
    tag = stored.http.get(path).headers["etag"]
    assert stored.http.get(path, headers={"If-None-Match": tag}).status_code == 304
    other = stored.http.get(path, params={"direction": "y"}, headers={"If-None-Match": tag})
    assert (other.status_code, other.headers["etag"] == tag) == (200, False)


@pytest.mark.parametrize(
    ("query", "field", "words"),
    [
        ({"bearing": "middle"}, "bearing", "left"),
        ({"quantity": "loudness"}, "quantity", "mesh_force"),
        ({"quantity": "mesh_force"}, "quantity", "varies over the run"),
        ({"direction": "up"}, "direction", "principal"),
    ],
)
def test_what_is_not_in_the_run_is_refused_by_its_name(stored, query, field, words):
    answer = stored.http.get(f"/v1/results/{LOUD}/sound", params=query)
    assert answer.status_code == 422, answer.text
    assert words in answer.text
    assert answer.json()["errors"][0]["field"] == field


def test_what_is_no_run_has_no_sound(stored):
    for key, against in ((TABLE, LOUD), ("d" * 64, LOUD), (LOUD, TABLE)):
        answer = stored.http.get(f"/v1/results/{key}/sound", params={"against": against})
        assert answer.status_code == 404, answer.text
