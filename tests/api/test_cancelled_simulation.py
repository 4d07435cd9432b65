"""A long simulation as a job: progress, memory that does not grow, and an end when it is cancelled."""

import os
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from own_process import children, command
from running_service import lives, until
from scene_files import scene_file

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import JobDismissed
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.schemas.scene import SceneInput
from service.app import create_app
from service.settings import Settings
from service.store.places import stored_results

KEY = "cd" * 32
DURATION, RATE = 900.0, 20e3
SAMPLE_BYTES = 8 * 2 * 5  # displacements and rates of five freedoms


@pytest.fixture(scope="module", autouse=True)
def warm_once():
    """Have a warm process of its own: the worker is found by its parent."""


@pytest.fixture
def data(tmp_path):
    return tmp_path / "data"


@pytest.fixture
def client(tmp_path, data):
    app = create_app(Settings(data_directory=data))
    scene_file(tmp_path)
    with (
        TestClient(app) as service,
        LineOfActionClient(
            "http://testserver", cache_dir=tmp_path / "results", transport=service._transport
        ) as found,
    ):
        stored_results(data).put(KEY, "database", tmp_path / "ste.nc")
        yield found


def workers() -> list[int]:
    """Children of the warm process of this one, or of this one, that run a job."""
    able = [pid for pid in children(os.getpid()) if b"service.worker.child\0" in command(pid)]
    warm = [pid for pid in able if b"fork_server" in command(pid)]
    return [pid for pid in able if pid not in warm] + [pid for one in warm for pid in children(one)]


def resident_bytes(pid: int) -> int:
    """Memory of a process that is its own: pages of files do not count."""
    lines = dict(
        line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines() if ":" in line
    )
    return 1024 * int(lines["RssAnon"].split()[0])


def written(data: Path) -> float:
    """Seconds of motion on disk."""
    files = list((data / "work").glob("*/run.nc.partial/run.states"))
    return sum(file.stat().st_size for file in files) / (SAMPLE_BYTES + 8) / RATE


@pytest.mark.law
def test_a_long_run_keeps_its_memory_and_ends_when_cancelled(client, tmp_path, data):
    given = read_model(SceneInput, scene_file(tmp_path, duration=DURATION, rate=RATE))
    (mesh,) = given.meshes
    mesh = mesh.model_copy(update={"database_file": None, "database_hash": KEY})
    job = client.simulate.submit(given.model_copy(update={"meshes": (mesh,)}))
    until(lambda: written(data) > 2.0)
    (pid,) = workers()
    before, at = resident_bytes(pid), written(data)
    until(lambda: written(data) > at + 20.0)
    held = (written(data) - at) * RATE * SAMPLE_BYTES
    assert held > 30e6  # what it would have grown by, had the states stayed in memory
    assert resident_bytes(pid) - before < 0.2 * held
    until(lambda: client.status(job.id).stage == "integration")
    state = client.status(job.id)
    assert (state.status, state.stage) == ("running", "integration")
    assert state.progress <= 100.0 * written(data) / DURATION + 1.0, "never ahead of the motion"

    assert client.dismiss(job.id).status == "dismissed"
    until(lambda: not lives(pid))
    until(lambda: not list((data / "work").iterdir()))
    assert workers() == []
    assert client.status(job.id).status == "dismissed"
    with pytest.raises(JobDismissed):
        client.result(job.id)
    again = client.simulate.submit(given.model_copy(update={"meshes": (mesh,)}))
    assert again.id != job.id and client.dismiss(again.id).status == "dismissed"
