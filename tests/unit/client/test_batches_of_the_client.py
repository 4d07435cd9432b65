"""Batches from both clients, against the service itself with fake work."""

from typing import Any

import pytest
from awaited import outcome
from served_app import served
from service_fakes import REGISTRY

from lineofaction.client import AsyncLineOfActionClient, LineOfActionClient
from lineofaction.client.offers import offers
from lineofaction.gearbox.problems import BadInput, JobDismissed, ServiceError
from service.app import create_app
from service.settings import Settings

WISHES: list[dict[str, Any]] = [{"text": "b"}, {"text": "a"}, {"mode": "mesh"}]


@pytest.fixture
def address(tmp_path):
    with served(create_app(Settings(data_directory=tmp_path / "service", workers=2), REGISTRY)) as port:
        yield f"http://127.0.0.1:{port}"


def test_both_clients_get_the_jobs_of_a_batch_in_order(address, tmp_path):
    assert "fake" not in offers()  # its results are read as files
    jobs = [{"wish": wish} for wish in WISHES]

    def blocking():
        with LineOfActionClient(address, cache_dir=tmp_path / "a") as client:
            batch = client.batch(client.submit_batch("fake", jobs).id)
            progress = [event.progress for event in batch.events()]
            ends = batch.wait()
            texts = [job.file().read_text() for job in ends[:2]]
            assert [state.place for state in client.jobs(parent=batch.id, status=["failed"])] == [2]
            assert [state.id for state in client.jobs()] == [batch.id]
            with pytest.raises(ServiceError, match="negative Jacobian") as caught:
                batch.result()
            assert "job 2 of batch" in caught.value.__notes__[0]
            assert progress == sorted(progress)
            return texts, [job.state.status for job in ends], batch.state.children

    async def awaited():
        async with AsyncLineOfActionClient(address, cache_dir=tmp_path / "b") as client:
            batch = await client.batch((await client.submit_batch("fake", jobs)).id)
            async for event in batch.events():
                assert event.children == 3
            ends = await batch.wait()
            texts = [(await job.file()).read_text() for job in ends[:2]]
            return texts, [job.state.status for job in ends], batch.state.children

    assert blocking() == outcome(awaited()) == (["b", "a"], ["successful", "successful", "failed"], 3)


def test_the_results_of_a_batch_are_a_list(address, tmp_path):
    with LineOfActionClient(address, cache_dir=tmp_path) as client:
        shared = {"wish": {"text": "x", "number": 1.0}}
        state = client.submit_batch("fake", [{}, {"wish": {"text": "y"}}], shared)
        files = client.batch(state.id).result(timeout=300.0)
        assert [file.read_text() for file in files] == ["x", "y"]


def test_a_batch_is_dismissed_and_refused_as_a_whole(address, tmp_path):
    with LineOfActionClient(address, cache_dir=tmp_path) as client:
        batch = client.batch(client.submit_batch("fake", [{"wish": {"mode": "hang"}}] * 2).id)
        assert batch.dismiss().status == "dismissed"
        with pytest.raises(JobDismissed):
            batch.result()
        with pytest.raises(BadInput) as caught:
            client.submit_batch("fake", [{"wish": {}}, {"wish": {"number": -1.0}}])
        assert [fault.field for fault in caught.value.faults] == ["jobs[1].wish.number"]
        assert len(list(client.jobs())) == 1
