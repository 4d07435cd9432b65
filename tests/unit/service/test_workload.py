"""Figures of the load: each computation is counted once, on the one database, and stays counted."""

from datetime import UTC, datetime, timedelta
from itertools import pairwise
from typing import Any

import pytest
from running_service import Bench, bench
from service_fakes import REGISTRY
from sqlalchemy import update

from service.queue.claims import Claim
from service.queue.retention import Retention
from service.queue.tables import computations, jobs
from service.queue.workload import BOUNDS_S, Durations, WorkloadReader, bound_of
from service.store.database import instant, writing


def set_back(machine: Bench, column: str, seconds: float) -> None:
    """Let all computations that wait or run have been entered, or have begun, so long ago."""
    before = instant(datetime.now(UTC) - timedelta(seconds=seconds))
    with writing(machine.engine) as connection:
        live = computations.c.state.in_(("accepted", "running"))
        connection.execute(update(computations).where(live).values({column: before}))


def begun(machine: Bench, text: str, seconds: float = 0.0) -> Claim:
    """Enter a computation and claim it; it began so long ago."""
    machine.submit(text=text)
    claim = machine.claimed()
    set_back(machine, "started", seconds)
    return claim


def ended(machine: Bench) -> dict[str, Durations]:
    found = WorkloadReader(machine.engine).read().durations
    assert {one.process for one in found} <= {"fake"}
    return {one.outcome: one for one in found}


def counts(histogram: Durations) -> dict[str, int]:
    numbers = [0, *(number for _, number in histogram.buckets)]
    steps = [upper - lower for lower, upper in pairwise(numbers)]
    return {le: step for (le, _), step in zip(histogram.buckets, steps, strict=True) if step}


def test_ends_are_counted_by_outcome_in_the_class_of_their_duration(machine):
    for number, seconds in enumerate((0.0, 90.0, 100.0, 9000.0)):
        machine.claims.succeed(begun(machine, f"case {number}", seconds))
    machine.claims.fail(begun(machine, "bad", 30.0), "no mesh")
    found = ended(machine)
    assert set(found) == {"successful", "failed"}
    assert counts(found["successful"]) == {"1.0": 1, "120.0": 2, "+Inf": 1}
    assert counts(found["failed"]) == {"60.0": 1}
    assert [le for le, _ in found["failed"].buckets] == [bound_of(bound) for bound in BOUNDS_S]
    assert found["failed"].seconds == pytest.approx(30.0, abs=10.0)  # of a busy machine
    assert found["successful"].seconds == pytest.approx(9190.0, abs=40.0)


def test_an_end_that_is_said_twice_is_counted_once(machine):
    """As when the answer to a commit was lost, or another scheduler was quicker."""
    claim = begun(machine, "once")
    for _ in range(2):
        machine.claims.succeed(claim)
        machine.claims.fail(claim, "late")
    assert {outcome: counts(one) for outcome, one in ended(machine).items()} == {"successful": {"1.0": 1}}


def test_dismissed_work_is_counted_if_it_had_begun(machine):
    waits = machine.submit(text="waits")
    machine.submissions.dismiss(waits.id)
    assert ended(machine) == {}
    machine.submissions.dismiss(machine.submit(text="again").id)
    job = machine.submit(text="runs")
    machine.claimed()
    machine.submissions.dismiss(job.id)
    machine.submissions.dismiss(job.id)
    assert {outcome: counts(one) for outcome, one in ended(machine).items()} == {"dismissed": {"1.0": 1}}


def test_attempts_add_up(machine):
    claim = begun(machine, "dies once")
    machine.claims.put_back(claim, "died", counted=True)
    again = machine.claimed()
    machine.claims.succeed(again)
    machine.claims.succeed(begun(machine, "lives"))
    assert ended(machine)["successful"].attempts == 3


def test_counts_outlive_what_they_count(machine):
    machine.claims.succeed(begun(machine, "old"))
    with writing(machine.engine) as connection:
        long_ago = "2020-01-01T00:00:00.000000Z"
        connection.execute(update(computations).values(updated=long_ago))
        connection.execute(update(jobs).values(created=long_ago))
    before = ended(machine)
    retention = Retention(machine.engine, machine.store, machine.settings.data_directory, 7.0)
    removed = list(retention.collect(1.0))
    assert [one.name.split()[0] for one in removed] == ["job"]
    assert WorkloadReader(machine.engine).read().states == {}
    assert ended(machine) == before


def test_all_services_of_a_database_tell_the_same(machine, tmp_path):
    address: Any = machine.settings.database_address or f"sqlite:///{tmp_path / 'service.sqlite3'}"
    other = bench(tmp_path / "other", REGISTRY, database_url=address)
    machine.claims.succeed(begun(machine, "here"))
    assert other.submit(text="there").status == "accepted"
    claim = other.claimed()
    other.claims.succeed(claim)
    here, there = (WorkloadReader(one.engine).read() for one in (machine, other))
    assert here == there
    assert counts(here.durations[0]) == {"1.0": 2}
    other.close()


def test_the_oldest_that_waits_has_its_age(machine):
    read = WorkloadReader(machine.engine).read
    assert read().oldest_waiting_s == 0.0
    machine.submit(text="old")
    set_back(machine, "created", 1000.0)
    machine.submit(text="young")
    assert 1000.0 <= read().oldest_waiting_s < 1100.0
    machine.claimed()
    assert read().oldest_waiting_s < 100.0


def test_results_are_added_up_by_kind(machine, tmp_path):
    for number, (kind, size) in enumerate((("database", 10), ("database", 300), ("frontier", 7))):
        file = tmp_path / "made"
        file.write_bytes(bytes(size))
        machine.store.put(f"{number}" * 64, kind, file)
    assert WorkloadReader(machine.engine).read().results == (("database", 2, 310), ("frontier", 1, 7))
