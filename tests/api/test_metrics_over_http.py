"""Figures for Prometheus: text that its parser reads, true for all services of one database."""

import platform
from concurrent.futures import ThreadPoolExecutor

import pytest
from fastapi.testclient import TestClient
from postgres_server import running_server
from prometheus_client import Metric
from prometheus_client.parser import text_string_to_metric_families
from running_service import until
from service_fakes import EXECUTION, REGISTRY

from fe_contact.solver_version import SOLVER_VERSION
from service.app import create_app
from service.settings import Settings
from service.store.database import Schema, database_engine


def families(client: TestClient) -> dict[str, Metric]:
    """Return the figures by name, read by Prometheus' own rules."""
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    found = list(text_string_to_metric_families(answer.text))
    assert len({family.name for family in found}) == len(found)
    assert all(family.documentation and family.type != "unknown" for family in found)
    return {family.name: family for family in found}


def value(family: Metric, suffix: str = "", **labels: str) -> float:
    (found,) = [
        one.value for one in family.samples if one.name == family.name + suffix and one.labels == labels
    ]
    return float(found)


def run(client: TestClient, mode: str, text: str) -> None:
    wish = {"mode": mode, "text": text}
    location = client.post(EXECUTION, json={"inputs": {"wish": wish}}).headers["location"]
    until(lambda: client.get(location).json()["status"] in ("successful", "failed"))


@pytest.mark.law
def test_figures_are_valid_and_tell_what_was_done(client):
    run(client, "write", "x" * 100)
    run(client, "write", "y" * 23)
    run(client, "die", "")
    found = families(client)
    taken, attempts = found["loa_computation_seconds"], found["loa_computation_attempts"]
    assert (taken.type, attempts.type) == ("histogram", "counter")
    for outcome, number, tries in (("successful", 2, 2), ("failed", 1, 2)):
        which = {"process": "fake", "outcome": outcome}
        assert value(taken, "_count", **which) == value(taken, "_bucket", **which, le="+Inf") == number
        assert value(taken, "_sum", **which) > 0.0
        assert value(attempts, "_total", **which) == tries
    assert value(found["loa_computations"], state="failed") == 1
    assert value(found["loa_results"], kind="database") == 2
    assert value(found["loa_result_bytes"], kind="database") == 123
    assert value(found["loa_oldest_waiting_seconds"]) == 0
    assert value(found["loa_database_up"]) == 1
    which = {"method": "POST", "route": EXECUTION, "status": "201"}
    assert value(found["loa_requests"], "_total", **which) == 3
    job = {"method": "GET", "route": "/v1/jobs/{job_id}", "status": "200"}
    assert value(found["loa_requests"], "_total", **job) >= 3


def test_workers_store_and_build_are_told(client):
    run(client, "write", "first")
    run(client, "write", "first")  # stored by now
    run(client, "die", "")
    found = families(client)
    assert value(found["loa_worker_starts"], "_total", process="fake") == 3
    for outcome, number in (("done", 1), ("died", 2)):
        assert value(found["loa_worker_ends"], "_total", process="fake", outcome=outcome) == number
    memory = found["loa_worker_peak_memory_bytes"]
    assert value(memory, "_count", process="fake") == 3
    assert 10e6 < value(memory, "_sum", process="fake") / 3 < 1e9
    assert 0.0 < value(found["loa_worker_cpu_seconds"], "_total", process="fake") < 60.0
    assert (value(found["loa_workers_busy"]), value(found["loa_workers_limit"])) == (0, 1)
    assert value(found["loa_scheduler_up"]) == 1
    assert 0.0 <= value(found["loa_scheduler_turn_age_seconds"]) < 60.0
    assert value(found["loa_result_lookups"], "_total", outcome="hit") == 1
    assert value(found["loa_result_lookups"], "_total", outcome="miss") == 2
    assert found["loa_queue_depth"].samples == []
    assert 0 < value(found["loa_data_free_bytes"]) < value(found["loa_data_size_bytes"])
    (build,) = found["loa_build_info"].samples
    assert build.labels["python"] == platform.python_version()
    assert build.labels["solver"] == SOLVER_VERSION
    assert value(found["process_resident_memory_bytes"]) > 10e6
    assert value(found["process_open_fds"]) > 3


def test_the_queue_is_told_by_process(client):
    for text in ("runs", "waits"):
        client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang", "text": text}}})
    busy = lambda: value(families(client)["loa_workers_busy"])  # noqa: E731
    until(lambda: busy() == 1)
    depth = families(client)["loa_queue_depth"]
    for state in ("running", "accepted"):
        assert value(depth, state=state, process="fake") == 1


def test_reads_of_the_compliance_cache_come_from_the_workers(client):
    run(client, "condense", "")
    reads = families(client)["loa_compliance_cache_reads"]
    assert value(reads, "_total", outcome="miss") == 2
    assert value(reads, "_total", outcome="hit") == 1


def test_warnings_of_workers_are_counted(client):
    run(client, "warn", "")
    assert value(families(client)["loa_worker_warnings"], "_total", process="fake") == 1


def test_event_streams_are_no_requests_that_take_long(client):
    location = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang"}}}).headers["location"]
    route = "/v1/jobs/{job_id}/events"

    def streams():
        open_streams = families(client)["loa_event_streams"]
        return sum(sample.value for sample in open_streams.samples if sample.labels == {"route": route})

    with ThreadPoolExecutor(1) as pool:
        heard = pool.submit(client.get, f"{location}/events")
        until(lambda: streams() == 1)
        client.delete(location)
        text = heard.result().text
    until(lambda: streams() == 0)
    found = families(client)
    events = [block for block in text.split("\n\n") if block.startswith("event: ")]
    assert value(found["loa_events"], "_total", route=route) == len(events) > 1
    assert value(found["loa_requests"], "_total", method="GET", route=route, status="200") == 1
    assert not [s for s in found["loa_request_seconds"].samples if s.labels["route"] == route]


@pytest.mark.law
def test_callers_choose_no_label(client):
    client.get("/metrics")
    for n in range(50):
        client.request(f"METHOD{n}", f"/nowhere/{n}")
        client.request("GET", f"/v1/jobs/{n}")
        client.request(f"X{n}", "/v1/jobs")
        client.get(f"/page/{n}.js", headers={"X-Request-ID": f"caller-{n}"})
        client.post(f"/v1/processes/p{n}/execution", json={})
    found = families(client)
    samples = [sample for family in found.values() for sample in family.samples]
    kinds = {(s.labels["method"], s.labels["route"]) for s in found["loa_requests"].samples}
    assert {method for method, _ in kinds} == {"GET", "POST", "other"}
    assert len(kinds) <= 8
    assert not [s for s in samples if any(word in str(s.labels) for word in ("METHOD", "nowhere", "caller"))]


def test_without_a_database_there_are_figures_that_say_so(tmp_path):
    with running_server() as server:
        url = server.new_database()
        Schema(engine := database_engine(url)).upgrade()
        engine.dispose()
        app = create_app(Settings(data_directory=tmp_path, database_url=url), REGISTRY)
        client = TestClient(app, raise_server_exceptions=False)
        assert value(families(client)["loa_database_up"]) == 1
    found = families(client)
    assert value(found["loa_database_up"]) == 0
    assert "loa_computations" not in found
    assert value(found["loa_requests"], "_total", method="GET", route="/metrics", status="200") == 1
    app.state.context.close()
