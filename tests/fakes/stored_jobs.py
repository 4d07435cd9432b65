"""A network in memory that holds results of all cases, for the client: jobs end after a few looks."""

import base64
import hashlib
import json
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
import pytest

from lineofaction.client import AsyncLineOfActionClient, LineOfActionClient

ADDRESS = "http://127.0.0.1:1"
_GEAR = {"face_width_mm": 25.0, "bore_diameter_mm": 40.0}


@dataclass
class StoredJobs:
    """Answers as the service does; `looks` is how often a job is seen running.

    The content of a result is the name of the case's pinion, in bytes.
    """

    looks: int = 1
    version: str = "1"
    keys: list[str] = field(default_factory=list)
    running: set[str] = field(default_factory=set)
    most_running: int = 0
    _seen: Counter[str] = field(default_factory=Counter)
    _content: dict[str, bytes] = field(default_factory=dict)

    def __call__(self, request: httpx2.Request) -> httpx2.Response:
        _, _, _, *parts = f"/{request.url.path}".split("/")
        if parts == [""]:
            return httpx2.Response(200, json={"version": self.version})
        if parts[0] == "processes":
            return self._enter(request, parts[1])
        if parts[0] == "jobs" and parts[-1] == "results":
            reference = {"href": f"/v1/results/{_key(parts[1])}", "type": "", "hash": _key(parts[1])}
            return httpx2.Response(200, json={"database": reference})
        if parts[0] == "jobs":
            return self._look(parts[1])
        return self._file(parts[1])

    def _enter(self, request: httpx2.Request, process: str) -> httpx2.Response:
        self.keys.append(request.headers["idempotency-key"])
        subject = json.loads(request.content)["inputs"]["case"]
        job = f"{process}-{subject['pair']['pinion']['teeth']}"
        self._content[_key(job)] = job.encode()
        self.running.add(job)
        self.most_running = max(self.most_running, len(self.running))
        return httpx2.Response(201, json=state(job, "running"))

    def _look(self, job: str) -> httpx2.Response:
        self._seen[job] += 1
        if self._seen[job] <= self.looks:
            return httpx2.Response(200, json=state(job, "running"))
        self.running.discard(job)
        return httpx2.Response(200, json=state(job, "successful"))

    def _file(self, key: str) -> httpx2.Response:
        content = self._content[key]
        digest = base64.b64encode(hashlib.sha256(content).digest()).decode()
        headers = {"Content-Digest": f"sha-256=:{digest}:", "Result-Kind": "database"}
        return httpx2.Response(200, content=content, headers=headers)


def against(
    network: Callable[[httpx2.Request], httpx2.Response], cache: Path, **options: Any
) -> LineOfActionClient:
    return LineOfActionClient(ADDRESS, cache_dir=cache, transport=httpx2.MockTransport(network), **options)


def awaited_against(
    network: Callable[[httpx2.Request], httpx2.Response], cache: Path
) -> AsyncLineOfActionClient:
    return AsyncLineOfActionClient(ADDRESS, cache_dir=cache, transport=httpx2.MockTransport(network))


def case(teeth: int = 20) -> dict[str, Any]:
    pair = {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": {"teeth": teeth, **_GEAR}}
    return {"pair": pair | {"wheel": {"teeth": 20, **_GEAR}}, "load": {"torque_n_m": [10.0, 100.0]}}


@pytest.fixture
def slept(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Record what would be slept, on a clock that goes on by it."""
    pauses: list[float] = []
    begin = time.monotonic()
    monkeypatch.setattr(time, "sleep", pauses.append)
    monkeypatch.setattr(time, "monotonic", lambda: begin + sum(pauses))
    return pauses


def state(job: str, status: str) -> dict[str, Any]:
    numbers = {"progress": 10, "stage_progress": 20}
    return {"jobID": job, "processID": "analyze", "status": status, "message": "", "stage": "mesh"} | numbers


def _key(job: str) -> str:
    return hashlib.sha256(job.encode()).hexdigest()
