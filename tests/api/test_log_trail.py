"""The log: from the identifier of a request to the worker that did the work, one text at a time."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import until
from service_fakes import EXECUTION, REGISTRY

from lineofaction.cli.serve import log_to_standard_error
from service.app import create_app
from service.settings import Settings


def grep(log: Path, text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in log.read_text().splitlines() if text in line]


def only(lines: list[dict[str, Any]], event: str) -> dict[str, Any]:
    (found,) = [line for line in lines if line["event"] == event]
    return found


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    file = tmp_path / "service.log"
    with file.open("w", buffering=1) as stream:
        monkeypatch.setattr("sys.stderr", stream)
        log_to_standard_error()
        yield file


def test_a_request_is_followed_to_its_worker_and_what_that_took(log: Path, tmp_path: Path) -> None:
    settings = Settings(data_directory=tmp_path / "data", attempts=2, memory_limit_mb=1000)
    with TestClient(create_app(settings, REGISTRY)) as client:
        answers = {}
        for mode in ("hog", "die_once"):
            body = {"inputs": {"wish": {"mode": mode}}}
            answers[mode] = client.post(EXECUTION, json=body)
            until(
                lambda where=answers[mode].headers["location"]: (
                    client.get(where).json()["status"]  # type: ignore[misc]
                    == "successful"
                )
            )
        shared = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hog"}}})
    entered = {
        mode: only(grep(log, answer.headers["x-request-id"]), "job entered")
        for mode, answer in answers.items()
    }
    assert entered["hog"]["job"] == answers["hog"].json()["jobID"]
    trail = grep(log, entered["hog"]["computation"])
    started, ended = only(trail, "worker started"), only(trail, "worker ended")
    (worker,) = (tmp_path / "data").glob(f"started_{entered['hog']['key'][:8]}")
    assert started["pid"] == ended["pid"] == int(worker.read_text().split()[0])
    assert (ended["outcome"], ended["attempt"], ended["process"]) == ("done", 1, "fake")
    assert ended["peak_mb"] > 300.0  # what it held
    assert ended["cpu_s"] > 0.0 and ended["seconds"] > 0.0
    again = [
        (line["outcome"], line["attempt"])
        for line in grep(log, entered["die_once"]["computation"])
        if line["event"] == "worker ended"
    ]
    assert again == [("died", 1), ("done", 2)]
    small = [line["peak_mb"] for line in grep(log, entered["die_once"]["computation"]) if "peak_mb" in line]
    assert 0.0 < small[-1] < ended["peak_mb"] - 250.0
    of_shared = only(grep(log, shared.headers["x-request-id"]), "job entered")
    assert of_shared["stored"] and of_shared["key"] == entered["hog"]["key"]


def test_what_ends_a_worker_is_named(log: Path, tmp_path: Path) -> None:
    settings = Settings(data_directory=tmp_path / "data")
    with TestClient(create_app(settings, REGISTRY)) as client:
        unwanted = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang", "text": "unwanted"}}})
        until(lambda: grep(log, "worker started") != [])
        client.delete(unwanted.headers["location"])
        until(lambda: grep(log, "worker ended") != [])
    hurried = settings.model_copy(update={"deadline_s": 0.5})
    with TestClient(create_app(hurried, REGISTRY)) as client:
        late = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang", "text": "late"}}})
        until(lambda: client.get(late.headers["location"]).json()["status"] == "failed")
    outcomes = {}
    for name, answer in (("late", late), ("unwanted", unwanted)):
        entered = only(grep(log, answer.headers["x-request-id"]), "job entered")
        outcomes[name] = only(grep(log, entered["computation"]), "worker ended")["outcome"]
    assert outcomes == {"late": "too late", "unwanted": "not wanted"}
