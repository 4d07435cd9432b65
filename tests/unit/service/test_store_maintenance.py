"""Verification and collection: what is needed stays, also while the service works."""

import hashlib
import json
import os
import threading

import pytest
from running_service import Bench, bench
from service_fakes import REGISTRY
from sqlalchemy import update
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.gearbox.problems import NoSuchJob, NotFound
from service.queue.job import Job
from service.queue.retention import Retention
from service.queue.tables import computations, jobs
from service.store.database import writing
from service.store.deployment import NOTE
from service.store.maintenance import is_quarantined, verify_store
from service.store.results import results

LONG_AGO = "2026-01-01T00:00:00.000000Z"
KEYS = [hashlib.sha256(bytes([n])).hexdigest() for n in range(4)]


@pytest.fixture(params=["directory", "s3"])
def machine(tmp_path, database_url, request):
    place = None if request.param == "directory" else str(request.getfixturevalue("s3_url"))
    found = bench(tmp_path / "data", REGISTRY, database_url=database_url, results_url=place)
    yield found
    found.close()


def retention(machine: Bench) -> Retention:
    return Retention(machine.engine, machine.store, machine.settings.data_directory, 7.0)


def in_service(machine: Bench) -> list[str]:
    """Return the names of the files that are neither a note nor in quarantine."""
    names = [file.name for file in machine.store.files.files()]
    return [name for name in names if name != NOTE and not is_quarantined(name)]


def collected(machine: Bench, days: float | None = None, *, dry_run: bool = False) -> list[tuple[str, str]]:
    """Return what is collected: why, and the last part of its name."""
    found = retention(machine).collect(days, dry_run=dry_run)
    return sorted((one.why, one.name.split("/")[-1]) for one in found)


def put(machine: Bench, key: str, content: bytes) -> str:
    file = machine.settings.data_directory / "made"
    file.write_bytes(content)
    return machine.store.put(key, "database", file).file


def done(machine: Bench, text: str) -> Job:
    """Enter a job and end it with its result, as a scheduler does."""
    job = machine.submit(text=text)
    claim = machine.claimed()
    put(machine, job.key, text.encode())
    machine.claims.succeed(claim)
    return job


def let_time_pass(machine: Bench, *kept: str) -> None:
    """Let all have been requested long ago, but the results and jobs of these keys."""
    with writing(machine.engine) as connection:
        connection.execute(update(results).where(results.c.key.not_in(kept)).values(used=LONG_AGO))
        connection.execute(update(computations).values(updated=LONG_AGO))
        connection.execute(update(jobs).values(created=LONG_AGO, asked=None))


def age(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every file be older than what is spared."""
    monkeypatch.setattr("service.store.maintenance.GRACE_S", -60.0)
    monkeypatch.setattr("service.queue.retention.GRACE_S", -60.0)


def test_every_file_is_compared_and_what_differs_is_set_aside(machine):
    names = [put(machine, key, b"table") for key in KEYS]
    (draft := machine.settings.data_directory / "other").write_bytes(b"tabla")
    machine.store.files.put(names[0], draft, hashlib.sha256(b"tabla").hexdigest())
    for copy in (machine.settings.data_directory / "cache").rglob("*.nc"):
        copy.unlink()
    machine.store.files.delete(names[1])
    found = verify_store(machine.store)
    assert (found.sound, found.damaged, found.missing) == (2, (names[0],), (names[1],))
    with pytest.raises(NotFound):
        machine.store.verified(KEYS[0], "database")
    assert verify_store(machine.store).damaged == ()


def test_orphans_and_half_written_files_go_and_all_else_stays(machine, monkeypatch):
    name = put(machine, KEYS[0], b"table")
    lost = put(machine, KEYS[1], b"lost")
    machine.store.files.delete(lost)
    (draft := machine.settings.data_directory / "orphan").write_bytes(b"orphan")
    for orphan in ("database/aa/orphan.nc", "database/aa/x.nc.0123.part", "database/aa/y.nc.damaged"):
        machine.store.files.put(orphan, draft, hashlib.sha256(b"orphan").hexdigest())
    assert collected(machine) == [("no file", lost.split("/")[-1])]  # the others are young
    age(monkeypatch)
    expected = [
        ("damaged", "y.nc.damaged"),
        ("half written", "x.nc.0123.part"),
        ("not in the index", "orphan.nc"),
    ]
    assert collected(machine, dry_run=True) == expected
    assert collected(machine) == expected
    assert collected(machine) == []
    assert in_service(machine) == [name]
    assert verify_store(machine.store).quarantined == 3
    assert machine.store.verified(KEYS[0], "database").path.read_bytes() == b"table"


def test_what_was_not_asked_for_expires_with_its_jobs(machine):
    old, asked, shown = (done(machine, text) for text in ("old", "asked", "shown"))
    waiting = machine.submit(text="waits")
    let_time_pass(machine)
    machine.store._noted.clear()
    machine.store.verified(asked.key, "database")
    machine.submissions.find(shown.id)
    removed = {name for _, name in collected(machine, 30.0)}
    assert {f"job {old.id}", f"job {asked.id}"} <= removed and f"job {shown.id}" not in removed
    for key in (old.key, shown.key):
        with pytest.raises(NotFound):
            machine.store.verified(key, "database")
    assert machine.store.verified(asked.key, "database").path.read_bytes() == b"asked"
    with pytest.raises(NoSuchJob):
        machine.submissions.find(old.id)
    assert machine.submissions.find(waiting.id).status == "accepted"
    assert machine.submit(text="old").status == "accepted"
    assert machine.submissions.counts() == {"accepted": 2, "successful": 1}


def test_a_result_that_is_asked_for_while_it_is_looked_at_stays(machine, monkeypatch):
    """The index was read, then the result was put again: the line is no more what was seen."""
    put(machine, KEYS[0], b"table")
    let_time_pass(machine)
    has = machine.store.files.has

    def put_meanwhile(name):
        monkeypatch.undo()
        put(machine, KEYS[0], b"table")
        return has(name)

    monkeypatch.setattr(machine.store.files, "has", put_meanwhile)
    assert collected(machine, 30.0) == []
    assert machine.store.verified(KEYS[0], "database").path.read_bytes() == b"table"


def test_workspaces_and_logs_of_ended_work_go(machine, monkeypatch):
    directory = machine.settings.data_directory
    ended, failed, running = (machine.submit(text=text) for text in ("ended", "failed", "running"))
    claims = [machine.claims.claim() for _ in range(3)]
    for claim in claims:
        (directory / "work" / claim.id).mkdir(parents=True)
        (directory / "log").mkdir(exist_ok=True)
        (directory / "log" / f"{claim.id}.log").write_text("said")
    (directory / "log" / "live.log").write_text("another's")
    assert claims[0] is not None and claims[1] is not None and claims[2] is not None
    machine.claims.succeed(claims[0])
    machine.claims.fail(claims[1], "see the log")
    age(monkeypatch)
    first, second, third = (claim.id for claim in claims if claim is not None)
    expected = sorted([("log", f"{first}.log"), ("workspace", first), ("workspace", second)])
    assert collected(machine) == expected
    assert [path.name for path in (directory / "work").iterdir()] == [third]
    assert {path.stem for path in (directory / "log").iterdir()} == {second, third, "live"}
    assert ended.id != failed.id != running.id


def test_collection_beside_writers_loses_nothing(machine):
    """Results are put and read while rounds of collection come and go."""
    stop = threading.Event()
    names = set()

    def collect():
        while not stop.is_set():
            list(retention(machine).collect(0.5))

    collector = threading.Thread(target=collect)
    collector.start()
    try:
        for n in range(12):
            key = hashlib.sha256(b"%d" % n).hexdigest()
            names.add(put(machine, key, b"%d" % n))
            assert machine.store.verified(key, "database").path.read_bytes() == b"%d" % n
    finally:
        stop.set()
        collector.join()
    assert {line.file for line in machine.store.lines()} == names
    assert verify_store(machine.store).sound == 12


def test_the_verbs_tell_and_do(tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_DATA_DIRECTORY", str(tmp_path))
    machine = bench(tmp_path, REGISTRY)
    names = [put(machine, key, b"table") for key in KEYS[:2]]
    run = CliRunner()
    assert "2 files intact, 0 damaged or missing" in run.invoke(app, ["store", "verify"]).stdout
    (tmp_path / "results" / names[0]).write_bytes(b"tabla")
    bad = run.invoke(app, ["store", "verify", "--json"])
    assert (bad.exit_code, json.loads(bad.stdout)["damaged"]) == (1, [names[0]])
    let_time_pass(machine)
    aside = tmp_path / "results" / (names[0] + ".damaged")
    os.utime(aside, (0.0, 0.0))
    trial = json.loads(run.invoke(app, ["store", "gc", "--dry-run", "--older-than", "30", "--json"]).stdout)
    assert sorted(one["why"] for one in trial["removed"]) == ["damaged", "not asked for"]
    assert aside.exists()
    told = run.invoke(app, ["store", "gc", "--older-than", "30"]).stdout
    assert told.endswith("2 removed\nof these 2 to quarantine for 7 days\n")
    assert not aside.exists() and machine.store.lines() == []
