"""Batches in the job table, on each database: progress by cost, ends, expiry."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from running_service import Bench
from sqlalchemy import select, update

from service.project import COMMON
from service.queue.entry import BatchCase, Entry
from service.queue.job import Job, JobFilter
from service.queue.retention import Retention
from service.queue.tables import computations, durations, jobs
from service.store.database import now, reading, writing

LONG_AGO = "2026-01-01T00:00:00.000000Z"


def entered(machine: Bench, costs: dict[str, float], name: str | None = None) -> str:
    cases = [BatchCase(key, {"wish": {"text": key}}, cost=cost) for key, cost in costs.items()]
    return Entry(machine.engine, 50, COMMON).batch("fake", cases, now(), name)


def seen(machine: Bench, batch: str) -> Job:
    machine.claims.advance_batches()
    return machine.submissions.find(batch)


def test_progress_is_the_share_of_the_cost_that_is_done(machine):
    batch = entered(machine, {"a": 9.0, "b": 3.0})
    assert (seen(machine, batch).fraction, seen(machine, batch).status) == (0.0, "running")
    first = machine.claimed()
    machine.reach(first, 1.0, 0.5)
    share = {"a": 9.0, "b": 3.0}[first.key] / 12.0
    assert seen(machine, batch).fraction == pytest.approx(0.5 * share)
    machine.claims.put_back(first, "again", counted=True)
    assert seen(machine, batch).fraction == pytest.approx(0.5 * share)  # it never falls
    for _ in range(2):
        machine.claims.succeed(machine.claimed())
    end = seen(machine, batch)
    assert (end.fraction, end.status, end.stage_fraction) == (1.0, "successful", 1.0)
    assert end.finished is not None


def test_no_scheduler_takes_a_batch_for_work(machine):
    batch = entered(machine, {"a": 1.0})
    assert machine.claimed().key == "a"
    assert machine.claims.claim() is None
    assert [claim.key for claim in machine.claims.running()] == ["a"]
    assert seen(machine, batch).status == "running"


def test_a_batch_that_is_entered_by_many_at_once_is_one(machine):
    with ThreadPoolExecutor(8) as pool:
        names = set(pool.map(lambda _: entered(machine, {"a": 1.0, "b": 1.0}, "same"), range(24)))
    (batch,) = names
    assert [job.key for job in machine.submissions.children(batch)] == ["a", "b"]
    assert machine.submissions.page(10) == [machine.submissions.find(batch)]
    assert len(machine.submissions.page(10, JobFilter(parent=batch))) == 2


def test_many_batches_at_once_and_schedulers_that_look_at_them(machine):
    with ThreadPoolExecutor(8) as pool:
        batches = list(pool.map(lambda n: entered(machine, {f"{n}": 1.0, "same": 1.0}), range(8)))
        while (claim := machine.claims.claim()) is not None:
            machine.claims.succeed(claim)
            list(pool.map(lambda _: machine.claims.advance_batches(), range(4)))
    ends = [seen(machine, batch) for batch in batches]
    assert {(end.status, end.message) for end in ends} == {("successful", "2 of 2 jobs have ended.")}


def test_a_batch_is_no_computation_of_the_figures(machine):
    batch = entered(machine, {"a": 1.0})
    assert machine.submissions.counts() == {"accepted": 1}
    machine.submissions.dismiss(batch)
    assert seen(machine, batch).status == "dismissed"
    other = entered(machine, {"b": 1.0})
    machine.claims.succeed(machine.claimed())
    assert seen(machine, other).status == "successful"
    assert machine.submissions.counts() == {"dismissed": 1, "successful": 1}
    with reading(machine.engine) as connection:
        (row,) = connection.execute(select(durations)).all()
    assert (row.process, row.outcome, row.number) == ("fake", "successful", 1)


def test_a_batch_expires_as_a_whole(machine):
    old, used, new = (entered(machine, {f"{n}{m}": 1.0 for m in "ab"}) for n in range(3))
    while (claim := machine.claims.claim()) is not None:
        machine.claims.succeed(claim)
    machine.claims.advance_batches()
    with writing(machine.engine) as connection:
        aged = jobs.c.id.in_([old, used]) | jobs.c.parent.in_([old, used])
        connection.execute(update(jobs).where(aged).values(created=LONG_AGO, asked=None))
        connection.execute(update(computations).values(updated=LONG_AGO))
    child = machine.submissions.children(used)[1]
    assert machine.submissions.find(child.id).parent == used  # one of its jobs was requested
    retention = Retention(machine.engine, machine.store, machine.settings.data_directory, 7.0)
    expired = [leftover.name for leftover in retention.expire(30.0) if leftover.why == "not asked for"]
    assert expired == [f"job {old}"]
    assert machine.submissions.children(old) == []
    assert len(machine.submissions.children(used)) == len(machine.submissions.children(new)) == 2
