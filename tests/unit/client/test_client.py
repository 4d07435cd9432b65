"""The client against a real app in the same process, and against a network that fails."""

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx2
import numpy as np
import pytest
from running_service import until
from service_fakes import REGISTRY
from small_table import small_table
from starlette.testclient import TestClient
from stored_jobs import against, case, state

from lineofaction.client import JobState, LineOfActionClient, OfflineWarning
from lineofaction.gearbox.problems import (
    BadInput,
    DamagedFile,
    JobDismissed,
    JobFailed,
    NotFound,
    StillRunning,
    Unreachable,
)
from service.app import create_app
from service.settings import Settings

KEY = "ab" * 32


@pytest.fixture
def service(tmp_path):
    """A running app with the fake and one table in its store."""
    app = create_app(Settings(data_directory=tmp_path / "data"), REGISTRY)
    file = tmp_path / "table.nc"
    small_table().to_netcdf(file)
    app.state.context.store.put(KEY, "database", file)
    with TestClient(app) as found:
        yield found


@pytest.fixture
def client(service, tmp_path):
    transport = service._transport
    with LineOfActionClient("http://testserver", cache_dir=tmp_path / "tables", transport=transport) as found:
        yield found


def wish(**facts: Any) -> dict[str, Any]:
    return {"wish": facts}


def test_submit_wait_result(client):
    seen: list[JobState] = []
    result = client.wait(client.submit("fake", wish(text="x")).id, seen.append, interval=0.02)
    assert (result.kind, len(result.key)) == ("database", 64)
    assert seen[-1].status == "successful" and seen[-1].progress == 100
    assert client.fetch_file(result.key).read_text() == "x"


def test_a_cached_table_needs_no_service(client, tmp_path):
    client.fetch(KEY)

    def silent(_request):
        raise AssertionError("the cache was not used")

    assert against(silent, tmp_path / "tables").fetch(KEY).identical(small_table())


def test_a_damaged_cache_is_not_used(client):
    file = client.fetch_file(KEY)
    file.write_bytes(file.read_bytes()[:-1] + b"?")
    assert client.fetch(KEY).identical(small_table())


def test_a_file_damaged_on_its_way_is_refused_and_not_kept(tmp_path):
    def damaged(_request):
        return httpx2.Response(200, content=b"half of", headers={"Content-Digest": "sha-256=:AAAA:"})

    with pytest.raises(DamagedFile):
        against(damaged, tmp_path / "tables").fetch_file(KEY)
    assert list((tmp_path / "tables").rglob("*.nc")) == []


@pytest.mark.parametrize(("mode", "error"), [("mesh", JobFailed), ("input", BadInput), ("die", JobFailed)])
def test_a_job_that_fails_raises_what_it_failed_of(client, mode, error):
    with pytest.raises(error):
        client.wait(client.submit("fake", wish(mode=mode)).id, interval=0.02)


def test_a_dismissed_job_raises(client):
    job = client.submit("fake", wish(mode="hang"))
    assert client.dismiss(job.id).status == "dismissed"
    with pytest.raises(JobDismissed):
        client.wait(job.id)


def test_waiting_ends_after_the_time_given_and_the_job_goes_on(client):
    job = client.submit("fake", wish(mode="hang"))
    with pytest.raises(StillRunning, match="It continues"):
        client.wait(job.id, timeout=0.1, interval=0.02)
    assert not client.status(job.id).ended
    client.dismiss(job.id)
    until(lambda: client.status(job.id).ended)


def test_a_bad_case_is_refused_before_anything_is_sent(tmp_path):
    def silent(_request):
        raise AssertionError("something was sent")

    wrong = case() | {"load": {"torque_n_m": [float("nan")]}}
    with pytest.raises(BadInput, match=r"load\.torque_n_m\[0\] = nan"):
        against(silent, tmp_path / "tables").analyze.submit(wrong)


@pytest.mark.parametrize("text", ["case.toml", "[pair]", b"case.toml", None, 3])
def test_what_is_neither_case_nor_path_is_refused_in_words(tmp_path, text):
    client = LineOfActionClient("http://127.0.0.1:9", cache_dir=tmp_path, attempts=1)
    for call, field in ((client.analyze, "case"), (client.simulate, "scene"), (client.ablate, "case")):
        with pytest.raises(BadInput, match=f"{field} = .*must be a Path, a dictionary.*pathlib"):
            call(text)


def test_unknown_results_and_jobs_are_not_found(client):
    with pytest.raises(NotFound):
        client.fetch("cd" * 32)
    with pytest.raises(NotFound):
        client.status("nothing")


def test_no_service_is_said_with_its_address_after_all_attempts(tmp_path):
    asked: list[str] = []

    def refuses(request):
        asked.append(request.method)
        raise httpx2.ConnectError("refused")

    with pytest.raises(Unreachable, match=r"http://127\.0\.0\.1:1 .*loa serve"):
        against(refuses, tmp_path / "tables", attempts=2).status("j")
    assert len(asked) == 2


def test_a_case_known_from_before_is_served_offline(tmp_path):
    file = tmp_path / "table.nc"
    small_table().to_netcdf(file)
    online = [True]
    content = file.read_bytes()

    def answer(request):
        if not online[0]:
            raise httpx2.ConnectError("refused")
        if request.url.path.endswith("/results"):
            reference = {"href": f"/v1/results/{KEY}", "type": "", "hash": KEY}
            return httpx2.Response(200, json={"database": reference})
        if "/v1/results/" in request.url.path:
            return httpx2.Response(200, content=content, headers=_digest(content))
        return httpx2.Response(201 if request.method == "POST" else 200, json=state("j", "successful"))

    client = against(answer, tmp_path / "tables", attempts=1)
    assert client.analyze(case()).identical(small_table())
    online[0] = False
    with pytest.warns(OfflineWarning, match=r"http://127\.0\.0\.1:1: the database .* from the cache"):
        assert client.analyze(case()).identical(small_table())
    with pytest.raises(Unreachable):
        client.analyze(case() | {"load": {"torque_n_m": [1.0]}})


def _digest(content: bytes) -> dict[str, str]:
    """Return the header of RFC 9530."""
    import base64  # noqa: PLC0415
    import hashlib  # noqa: PLC0415

    return {"Content-Digest": f"sha-256=:{base64.b64encode(hashlib.sha256(content).digest()).decode()}:"}


def test_the_import_is_light():
    heavy = {"gmsh", "skfem", "fastapi", "starlette", "sqlalchemy", "uvicorn"}
    heavy |= {"scipy", "numba", "xarray", "h5py", "matplotlib", "plotly"}
    own = {
        "service.app",
        "lineofaction.gearbox.convert",
        "service.queue",
        "service.worker",
        "service.settings",
    }
    code = "import json, sys, lineofaction.client; print(json.dumps(list(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(json.loads(done.stdout))
    assert not (heavy | own) & loaded
    # what declares the fields of cases and scenes is loaded when the first one is sent
    packages = {name.partition(".")[0] for name in loaded}
    assert not {"fe_contact", "dynamics", "bounds", "numpy"} & packages


@pytest.mark.law
def test_a_table_fetched_as_a_dataset_is_the_same_table(client):
    found, expected = client.fetch_dataset(KEY), small_table().to_xarray()
    assert found.equals(expected)
    assert found["static_transmission_error"].attrs["units"] == "m"
    assert set(expected.attrs) <= set(found.attrs)


def test_arrays_are_asked_as_lists_are(client):
    position, deflection = np.linspace(0.0, 1.0, 7), np.float64(3.0)
    asked = client.query(KEY, position, deflection)
    assert asked == client.query(KEY, position.tolist(), [3.0])
    assert asked == client.query(KEY, position[::-1][::-1], np.full(7, 3.0))


def test_threads_share_one_client(client):
    """Eight threads submit the same job, query and fetch: one computation, equal answers, sound files."""

    def ask(number):
        result = client.wait(client.submit("fake", wish(text="shared")).id, interval=0.02)
        return (
            client.fetch_file(result.key).read_text(),
            client.fetch(KEY).identical(small_table()),
            client.query(KEY, [0.1 * number], 3.0).force_n,
        )

    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(ask, range(8)))
    assert {text for text, _, _ in answers} == {"shared"}
    assert all(same for _, same, _ in answers)
    expected = small_table().force_at([0.1 * number for number in range(8)], 3e-6).force
    assert [force for _, _, (force,) in answers] == pytest.approx(expected.tolist())
