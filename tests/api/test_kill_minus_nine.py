"""kill -9 of workers, servers and schedulers, and a database that is cut off or falls, at random moments.

No job is lost, none ends with another result, no process is left, no partial file is served. Fifty moments on
each database at night, figures in out/kills_*.json; a few on one with every change.
"""

import json
import random
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from cut_connections import relay
from dask_processes import dask_processes
from killed_service import KilledService
from postgres_server import migrated, running_server
from running_service import until
from service_fake_work import is_slow_content

from service.store.maintenance import verify_store
from service.store.places import stored_results

SEED = 20261120
COMMON = {"LOA_WORKERS": "2", "LOA_ATTEMPTS": "10"}
FIGURES = Path(__file__).parents[2] / "out"


@pytest.fixture
def service(request, tmp_path):
    """On a SQLite file, with the workers of Dask beside it or not, or on PostgreSQL over a relay.

    A Dask worker and its scheduler are killed, too; PostgreSQL has connections ended by its administrator,
    and is itself stopped without notice and started again.
    """
    settings = COMMON | {"LOA_RESULTS_URL": (tmp_path / "results").as_uri()}
    if request.getfixturevalue("database") != "postgresql":
        settings["LOA_DATABASE_URL"] = f"sqlite:///{tmp_path / 'shared.sqlite3'}"
    if request.getfixturevalue("database") == "sqlite":
        yield KilledService(tmp_path, settings)
        return
    if request.getfixturevalue("database") == "dask":
        with dask_processes(tmp_path, 2, LOA_DATA_DIRECTORY=str(tmp_path / "worker")) as dask:
            harms = {"Dask worker": dask.kill_worker, "Dask scheduler": dask.fall_and_rise}
            yield KilledService(tmp_path, settings | {"LOA_SCHEDULER": dask.address}, harms)
        return
    with running_server() as server, relay(server.socket) as between:
        direct = migrated(server.new_database())
        settings["LOA_DATABASE_URL"] = direct.partition("?")[0].replace("@", f"@127.0.0.1:{between.port}")
        harms = {
            "connections ended": lambda: server.end_connections(direct),
            "connections cut": between.cut,
            "database restarted": lambda: server.fall_and_rise(random.uniform(0.0, 8.0)),
        }
        yield KilledService(tmp_path, settings, harms)


@pytest.mark.law
@pytest.mark.parametrize(
    ("database", "moments"),
    [
        ("sqlite", 3),
        pytest.param("sqlite", 50, marks=pytest.mark.nightly),
        pytest.param("postgresql", 50, marks=pytest.mark.nightly),
        pytest.param("dask", 50, marks=pytest.mark.nightly),
    ],
)
def test_nothing_is_lost_when_parts_are_killed_at_random_moments(service, tmp_path, database, moments):
    chance, began = random.Random(SEED), time.monotonic()
    kinds = [kind for _ in range(moments) for kind in chance.sample(service.kinds, len(service.kinds))]
    with service:
        service.measure("undisturbed")
        for number in range(moments):
            service.submit(f"case {number}")
            service.submit(f"case {chance.randrange(number + 1)}")  # shared, or done already
            service.strike(kinds[number], chance)
            sys.stdout.write(f"{time.monotonic() - began:.0f} s, {number}: {service.struck[-1]}\n")
        ends = service.settled()
        assert {end["status"] for end in ends.values()} == {"successful"}, ends
        for text in {*service.jobs.values()}:
            until(lambda text=text: text in service.witness.served)
        revived = service.server.revived
        assert service.stop() == 0
        until(lambda: service.marked() == [])
    assert service.witness.faults == []
    log = service.server.log.read_text()
    assert "service/queue/" not in log and ("Traceback" not in log or database == "dask")  # its library's own
    texts = ["undisturbed", *(f"case {number}" for number in range(moments))]
    served = {text: len(digests) for text, digests in service.witness.served.items()}
    assert served == dict.fromkeys(texts, 1)
    place = service.settings
    store = stored_results(tmp_path / "reader", place["LOA_DATABASE_URL"], place["LOA_RESULTS_URL"])
    assert len(store.lines()) == verify_store(store).sound == len(texts)
    figures = {
        "struck": Counter(service.struck),
        "jobs": len(ends),
        "cases": len(texts),
        "jobs with further attempts": sum(end["attempts"] > 1 for end in ends.values()),
        "most attempts": max(end["attempts"] for end in ends.values()),
        "answers to the witness": service.witness.answers,
        "times the server ended by itself": revived,
        "seconds": round(time.monotonic() - began),
    }
    FIGURES.mkdir(exist_ok=True)
    (FIGURES / f"kills_{database}.json").write_text(json.dumps(figures, indent=1), encoding="utf-8")
    sys.stdout.write(f"{figures}\n")


def test_the_witness_knows_a_partial_file_and_a_second_result():
    """The test above can fail: results of two attempts differ, and a part of one is none."""
    from service_fake_work import is_slow_content, slow_content  # noqa: PLC0415

    one, other = slow_content("case 0"), slow_content("case 0")
    assert one != other and is_slow_content(one, "case 0") and is_slow_content(other, "case 0")
    assert not is_slow_content(one, "case 1")
    assert not is_slow_content(one[:-1], "case 0")
    assert not is_slow_content(one[: len(one) // 2] + other[len(one) // 2 :], "case 0")


def starts(folder: Path) -> int:
    """Return how many children have begun jobs of the service in a folder."""
    return sum(len(file.read_text().splitlines()) for file in (folder / "server").glob("started_*"))


@pytest.mark.law
def test_kills_of_the_server_cost_a_job_no_attempt(tmp_path):
    """Under default settings, which give a job two attempts."""
    service, kills = KilledService(tmp_path, {}), 2
    with service:
        service.measure("undisturbed")
        service.submit("struck")
        for number in range(kills):
            until(lambda number=number: service.revive() or starts(tmp_path) > 1 + number)
            service.kill()
        ends = service.settled().values()
    assert starts(tmp_path) == 1 + kills + 1
    assert {(end["status"], end["attempts"]) for end in ends} == {("successful", 1)}, ends


# Batches: entered once and whole, they end and have the results of their jobs in order.


BATCH_SEED = 20261122


def ended(service: KilledService, batch: str) -> dict[str, Any]:
    found: dict[str, Any] = {}

    def over():
        service.revive()
        found.update(service.request("GET", f"/v1/jobs/{batch}").json())
        return found["status"] in ("successful", "failed", "dismissed")

    until(over)
    return found


@pytest.mark.parametrize("moments", [3, pytest.param(30, marks=pytest.mark.nightly)])
def test_batches_are_whole_whatever_is_killed(tmp_path, moments):
    chance = random.Random(BATCH_SEED)
    place = {"LOA_DATABASE_URL": f"sqlite:///{tmp_path / 'shared.sqlite3'}"}
    place["LOA_RESULTS_URL"] = (tmp_path / "results").as_uri()
    service = KilledService(tmp_path, COMMON | place)
    texts = {f"batch {n}": [f"{n} {m}" for m in range(3)] + ["all", f"{n} 0"] for n in range(moments)}
    with service, ThreadPoolExecutor(1) as pool:
        batches = {}
        service.request("GET", "/ready")
        for number, (name, wishes) in enumerate(texts.items()):
            entry = pool.submit(service.submit_batch, name, wishes)
            kind = ("entry", "worker", "server")[number % 3]
            if kind == "entry":  # while it is entered
                time.sleep(chance.uniform(0.0, 0.05))
                service.kill()
            batches[name] = entry.result()
            if kind != "entry":
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
        assert service.stop() == 0
        until(lambda: service.marked() == [])
    assert "Traceback" not in service.server.log.read_text()
