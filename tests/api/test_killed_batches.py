"""kill -9 of the parts of a service while batches are entered and computed.

Every batch that is submitted is entered once and whole, ends, and has the results of its jobs in order.
"""

from __future__ import annotations

import random
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from killed_service import KilledService
from running_service import until
from service_fake_work import is_slow_content

SEED = 20261122
SETTINGS = {"LOA_WORKERS": "2", "LOA_ATTEMPTS": "10", "LOA_LEASE_S": "5"}


def ended(service: KilledService, batch: str) -> dict[str, Any]:
    found: dict[str, Any] = {}

    def over() -> bool:
        service.revive()
        found.update(service.request("GET", f"/v1/jobs/{batch}").json())
        return found["status"] in ("successful", "failed", "dismissed")

    until(over)
    return found


@pytest.mark.parametrize("moments", [3, pytest.param(30, marks=pytest.mark.nightly)])
def test_batches_are_whole_whatever_is_killed(tmp_path: Path, moments: int) -> None:
    chance = random.Random(SEED)
    place = {"LOA_DATABASE_URL": f"sqlite:///{tmp_path / 'shared.sqlite3'}"}
    place["LOA_RESULTS_URL"] = (tmp_path / "results").as_uri()
    service = KilledService(tmp_path, SETTINGS | place, ["all", "work"])
    texts = {f"batch {n}": [f"{n} {m}" for m in range(3)] + ["all", f"{n} 0"] for n in range(moments)}
    with service, ThreadPoolExecutor(1) as pool:
        batches = {}
        service.request("GET", "/ready")
        for number, (name, wishes) in enumerate(texts.items()):
            entry = pool.submit(service.submit_batch, name, wishes)
            kind = ("all", "worker", "work")[number % 3]
            if kind == "all":  # while it is entered
                time.sleep(chance.uniform(0.0, 0.05))
                service.kill(service.parts[0])
            batches[name] = entry.result()
            if kind != "all":
                service.strike(kind, chance)
        for name, wishes in texts.items():
            end = ended(service, batches[name])
            assert (end["status"], end["progress"], end["children"]) == ("successful", 100, len(wishes)), end
            results = service.request("GET", f"/v1/jobs/{batches[name]}/results").json()["jobs"]
            files = [service.request("GET", r["results"]["database"]["href"] + "/file") for r in results]
            assert [is_slow_content(f.content, text) for f, text in zip(files, wishes, strict=True)]
            assert service.submit_batch(name, wishes) == batches[name]
        entered = service.request("GET", "/v1/jobs", params={"limit": 1000}).json()["jobs"]
        assert sorted(job["jobID"] for job in entered) == sorted(batches.values())
        assert service.stop() == [0, 0]
        until(lambda: service.marked() == [])
    assert [part.log.name for part in service.parts if "Traceback" in part.log.read_text()] == []
