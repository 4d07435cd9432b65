"""Queues as former versions wrote them: every job keeps its identifier and is done by this version.

tests/reference/waiting_jobs_VERSION.sql.gz are dumps of the SQLite files of data folders: VERSION entered
twenty analyses over HTTP, from 50 to 145 N m, and did none.
"""

import gzip
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from running_service import Bench, bench

from service.version import solver_version
from service.worker.process import ANALYZE, Registry

DUMPS = Path(__file__).parents[2] / "reference"
NUMBER = 20


@pytest.fixture(scope="module", autouse=True)
def migrated_once():
    """Let migrations upgrade the tables of these versions."""


def upgraded(folder: Path, version: str, change: str = "") -> Bench:
    """Return this version on the data folder of another, after a `change` in SQL of what waits."""
    dump = gzip.decompress((DUMPS / f"waiting_jobs_{version}.sql.gz").read_bytes()).decode()
    with closing(sqlite3.connect(folder / "service.sqlite3")) as database:
        database.executescript(dump + change)
    work = replace(ANALYZE, entry="service_fake_work:named")  # real inputs and names, quick work
    return bench(folder, Registry(work), workers=2)


@pytest.mark.law
@pytest.mark.parametrize("version", ["0.2.0", "0.3.0.dev442"])
def test_twenty_waiting_jobs_are_done_after_an_upgrade(tmp_path, version):
    machine = upgraded(tmp_path, version)
    before = machine.submissions.page(100)
    assert [job.status for job in before] == ["accepted"] * NUMBER
    machine.scheduler.start()
    after = [machine.ended(job) for job in before]
    assert {(job.status, job.attempts) for job in after} == {("successful", 1)}, after[0].message
    assert [job.id for job in after] == [job.id for job in before]
    assert [machine.store.verified(job.key, "database").path.read_text() for job in after] == [
        job.key for job in after
    ]
    assert len({job.key for job in after}) == NUMBER
    machine.close()


def test_what_no_longer_validates_ends_with_its_field_and_the_others_run(tmp_path):
    """The oldest job has another number of teeth here, as if a former version had allowed it."""
    teeth = """replace(inputs, '"teeth": 20', '"teeth": -20')"""
    which = "(SELECT computation_id FROM job ORDER BY created LIMIT 1)"
    machine = upgraded(tmp_path, "0.2.0", f"UPDATE computation SET inputs = {teeth} WHERE id = {which};")
    machine.scheduler.start()
    ended = [machine.ended(job) for job in machine.submissions.page(100)]
    (refused,) = [job for job in ended if job.status == "failed"]
    text = f"Version 0.2.0 entered the job; {solver_version()} refuses it: "
    assert refused.message.startswith(text)
    assert {fault["field"] for fault in refused.faults} >= {"case.pair.pinion.teeth"}
    assert [job.status for job in ended].count("successful") == NUMBER - 1
    machine.close()
