"""Cost limits of jobs: refused by the plan, ended by the CPU time, extended by jobs that share the work."""

import time
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import Bench, bench, until
from service_fakes import REGISTRY

from host import family_cpu_seconds
from lineofaction.gearbox.problems import BadInput
from service.access.holder import Holder
from service.access.key_file import KeyFile
from service.app import create_app
from service.queue.job import Job
from service.queue.terms import KEYLESS_CALLER, Terms, cost_limit, refuse_beyond
from service.schemas.examples import CASE
from service.settings import Settings


@pytest.fixture
def machine(tmp_path, database_url):
    found = bench(tmp_path, REGISTRY, database_url=database_url)
    found.scheduler.start()
    yield found
    found.close()


def entered(machine: Bench, limit: float | None) -> Job:
    """Enter a job that takes all the CPU time it gets, in a child process of its worker."""
    inputs = {"wish": {"mode": "burn"}}
    terms = Terms(max_cost_s=limit)
    job = machine.submissions.submit("fake", "burn", inputs, stored=False, terms=terms)
    machine.scheduler.wake()
    return job


def spent(machine: Bench) -> float:
    """Return the CPU seconds of the one worker; 0 without one."""
    running = list(machine.scheduler._running.values())
    return (family_cpu_seconds(running[0].worker.pid) or 0.0) if running else 0.0


@pytest.mark.law
def test_work_ends_at_its_limit_and_says_what_to_lower(machine):
    ended = machine.ended(entered(machine, 1.5))
    assert (ended.status, ended.attempts, ended.max_cost_s) == ("failed", 1, 1.5)
    assert ended.message.startswith("The limit of 1.5 CPU s (max_cost_s) was reached. Select a coarser level")


def test_work_may_cost_what_the_most_generous_of_its_jobs_allows(machine):
    first = entered(machine, 0.5)
    assert entered(machine, 0.3).max_cost_s == 0.5
    assert entered(machine, 5e3).max_cost_s == 5e3
    until(lambda: spent(machine) > 1.5)
    time.sleep(1.5)  # three turns of the scheduler
    assert machine.submissions.find(first.id).status == "running"
    assert entered(machine, None).max_cost_s is None
    assert entered(machine, 0.1).max_cost_s is None


def test_the_lower_of_both_limits_holds():
    bounded = Holder(name="ann", max_cost_s=60)
    assert cost_limit(None, KEYLESS_CALLER) is None
    assert cost_limit(5.0, KEYLESS_CALLER) == cost_limit(5.0, bounded) == 5.0
    assert cost_limit(None, bounded) == cost_limit(100.0, bounded) == 60


def test_a_prediction_beyond_the_limit_is_told_with_its_largest_stages():
    stages = {"mesh": 0.5, "compliance": 40.0, "contact": 9.5}
    refuse_beyond(50.0, stages)
    refuse_beyond(0.1, {})  # nothing is predicted
    with pytest.raises(
        BadInput, match=r"predicted cost, 50 CPU s \(compliance 40 s, contact 9.5 s\).*coarser"
    ):
        refuse_beyond(49.0, stages)


@pytest.fixture
def client(tmp_path):
    """A client of an app whose scheduler does not run; plans are made."""
    app = create_app(Settings(data_directory=tmp_path))
    yield TestClient(app)
    app.state.context.stop_waiting()
    app.state.context.close()


def analyzed(client: TestClient, **terms: Any) -> Any:
    return client.post("/v1/processes/analyze/execution", json={"inputs": {"case": CASE}, **terms})


def test_a_table_that_is_planned_to_cost_more_is_not_entered(client, tmp_path):
    plan = client.post("/v1/plans", json={"inputs": {"case": CASE}}).json()["prediction"]["cpu_seconds"]
    refused = analyzed(client, max_cost_s=0.9 * plan)
    assert refused.status_code == 422
    (fault,) = refused.json()["errors"]
    assert fault["field"] == "max_cost_s"
    assert "CPU s (" in fault["bound"]
    assert client.get("/v1/jobs").json()["jobs"] == []
    assert analyzed(client, max_cost_s=1.1 * plan).json()["max_cost_s"] == pytest.approx(1.1 * plan)
    key = KeyFile(tmp_path / "keys.json").add("ann", max_cost_s=1)
    client.headers["Authorization"] = f"Bearer {key}"
    assert (analyzed(client).status_code == 422) == (plan > 1.0)
    assert analyzed(client, max_cost_s=1e-3).status_code == 422


def test_what_is_stored_costs_nothing(tmp_path):
    app = create_app(Settings(data_directory=tmp_path))
    key = app.state.context.registry["analyze"].key(
        app.state.context.registry["analyze"].prepare(_inputs(app), app.state.context.store)
    )
    file = tmp_path / "stored.nc"
    file.write_bytes(b"a table")
    app.state.context.store.put(key, "database", file)
    job = analyzed(TestClient(app), max_cost_s=1e-3)
    assert (job.status_code, job.json()["status"]) == (201, "successful")
    app.state.context.close()


def _inputs(app: Any) -> Any:
    return app.state.context.registry["analyze"].inputs.model_validate({"case": CASE})
