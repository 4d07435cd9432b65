"""Motions of a unit over HTTP: modes of a stored analysis along its shafts, of such results alone."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient
from flexible_scenes import flexible_pair
from small_table import small_table

from dynamics.assembly.assemble import assemble
from dynamics.deflection import Deflection, LoadCase, deflect
from dynamics.linearize import ModalAnalysis, modal_analysis
from lineofaction.client import LineOfActionClient as Client
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, Outline
from lineofaction.gearbox.studies.deflect.run import RUN as DEFLECT
from service.app import create_app
from service.settings import Settings

MODES, OLDER, BROKEN, TABLE, BENT = ("a" * 64, "b" * 64, "c" * 64, "d" * 64, "f" * 64)


@dataclass(frozen=True)
class Stored:
    """A service with modes, those of a version without axes, ones that are not finite, and a table."""

    http: TestClient
    modes: ModalAnalysis
    deflection: Deflection

    def get(self, key: str, **query: object):
        return self.http.get(f"/v1/results/{key}/motion", params=query)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    folder = tmp_path_factory.mktemp("service")
    modes = modal_analysis(assemble(flexible_pair()), [0.0, 100.0])
    without = {"axis_shaft": np.empty(0, dtype=np.int64), "axis_position": np.empty(0)}
    files = {
        MODES: ("modes", modes),
        OLDER: ("modes", replace(modes, **without, axis_motion=np.empty((0, 6, 0)))),
        BROKEN: ("modes", replace(modes, axis_motion=np.full_like(modes.axis_motion, np.nan))),
        TABLE: ("database", small_table()),
    }
    scene = flexible_pair()
    cases = (LoadCase("cruise"), LoadCase("top", factor=2.0))
    bent = GearboxDeflection(deflect(scene, cases, 3), (), 1, 0.0, True, Outline.of(scene), {}, 0.0)
    app = create_app(Settings(data_directory=folder / "data"))
    with TestClient(app) as http:
        for key, (kind, result) in files.items():
            result.to_netcdf(folder / f"{key}.nc")
            app.state.context.store.put(key, kind, folder / f"{key}.nc")
        DEFLECT.file.write(bent, folder / "bent.nc")
        app.state.context.store.put(BENT, "deflection", folder / "bent.nc")
        yield Stored(http, modes, bent.deflection)


@pytest.mark.law
def test_every_mode_is_listed_and_moves_the_shafts_as_the_analysis_says(stored):
    listed = stored.get(MODES).json()
    assert listed["motion"] is None
    assert [group["name"] for group in listed["groups"]] == ["at rest", "at 0 rpm", "at 954.93 rpm"]
    rest = listed["groups"][0]["motions"]
    assert len(rest) == stored.modes.natural_frequency.size
    number = int(np.flatnonzero(stored.modes.natural_frequency > 0.0)[0])
    motion = stored.get(MODES, number=number).json()["motion"]
    assert motion["oscillates"] is True
    expected = stored.modes.axis_motion @ stored.modes.natural_shape[number]
    for index, shaft in enumerate(motion["shafts"]):
        own = np.flatnonzero(stored.modes.axis_shaft == index)
        ends = np.array(shaft["real"])[[0, -1]] * [1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0]
        np.testing.assert_allclose(ends, expected[own[[0, -1]]], rtol=1e-5)
        assert np.all(np.array(shaft["imaginary"]) == 0.0)
    last = sum(len(group["motions"]) for group in listed["groups"]) - 1
    whirl = stored.get(MODES, number=last).json()["motion"]
    assert any(np.any(np.array(shaft["imaginary"]) != 0.0) for shaft in whirl["shafts"])


@pytest.mark.law
def test_a_deflection_stands_under_every_load_case(stored):
    (group,) = stored.get(BENT).json()["groups"]
    assert [name.partition(",")[0] for name in group["motions"]] == ["cruise", "top"]
    motion = stored.get(BENT, number=1).json()["motion"]
    assert motion["oscillates"] is False
    lines = stored.deflection.cases[1].shafts
    for index, shaft in enumerate(motion["shafts"]):
        own = lines.shaft == index
        along = np.linspace(*shaft["position_mm"], 33) * 1e-3
        for k, scale in enumerate((1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0)):
            expected = np.interp(along, lines.position[own], lines.motion[own, k])
            np.testing.assert_allclose(np.array(shaft["real"])[:, k] * scale, expected, rtol=1e-5, atol=1e-12)


def test_a_client_reads_what_the_service_answers(stored, tmp_path):
    with Client("http://testserver", cache_dir=tmp_path, transport=stored.http._transport) as client:
        listed = client.motion(MODES)
        assert listed.motion is None and listed.groups[0].name == "at rest"
        assert client.motion(MODES, 1).model_dump() == stored.get(MODES, number=1).json()
        with pytest.raises(BadInput, match="number"):
            client.motion(MODES, 100_000)


def test_it_is_sent_once_to_who_has_it(stored):
    first = stored.get(MODES, number=1)
    again = stored.http.get(
        f"/v1/results/{MODES}/motion",
        params={"number": 1},
        headers={"If-None-Match": first.headers["etag"]},
    )
    assert again.status_code == 304
    assert stored.get(MODES, number=2).headers["etag"] != first.headers["etag"]


@pytest.mark.parametrize(
    ("key", "number", "status", "words"),
    [
        (MODES, 999_999, 422, "the number of motions"),
        (MODES, -1, 422, "number"),
        (MODES, 10**30, 422, "number"),
        (MODES, "nan", 422, "number"),
        (OLDER, None, 404, "older version"),
        (TABLE, None, 404, "no motion"),
        ("e" * 64, 0, 404, "e" * 64),
        (BROKEN, 0, 500, "not finite"),
    ],
)
def test_what_is_no_motion_is_refused(stored, key, number, status, words):
    answer = stored.get(key, **({} if number is None else {"number": number}))
    assert (answer.status_code, words in answer.text) == (status, True), answer.text


def test_a_damaged_file_is_refused(stored):
    file = Path(stored.http.app.state.context.store.verified(OLDER).path)
    file.write_bytes(file.read_bytes()[:500])
    answer = stored.get(OLDER, number=0)
    assert answer.json()["detail"]
    assert answer.status_code in (404, 500)
