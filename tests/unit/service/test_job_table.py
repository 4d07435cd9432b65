"""The job table: single flight, shared dismissal, bounded queue, order."""

import uuid
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest
from running_service import Bench, bench
from service_fakes import REGISTRY
from sqlalchemy import event

from lineofaction.gearbox.problems import NoSuchJob, QueueFull
from service.access.holder import Holder
from service.queue.claims import Claims
from service.queue.job import Job
from service.queue.terms import KEYLESS_CALLER, Terms
from service.store.database import instant, now
from service.store.results import Mark


@pytest.fixture
def machine(tmp_path, database_url):
    """The table without a running scheduler, on each database."""
    found = bench(tmp_path, REGISTRY, queue_limit=3, database_url=database_url)
    yield found
    found.close()


def test_equal_work_submitted_at_once_from_many_threads_is_one_computation(machine):
    with ThreadPoolExecutor(16) as pool:
        jobs = list(pool.map(lambda _: machine.submit(text="same"), range(64)))
    assert len({job.id for job in jobs}) == 64
    assert machine.submissions.counts() == {"accepted": 1}
    machine.claimed()
    assert machine.claims.claim() is None


def reused(machine: Bench, stated: str = "{}", caller: Holder = KEYLESS_CALLER, key: str = "ab" * 32) -> Job:
    terms = Terms(stated=stated, reuse=True)
    stored = machine.store.find(key, "database") is not None
    return machine.submissions.submit("fake", key, {"wish": {}}, stored=stored, caller=caller, terms=terms)


def test_an_equal_job_of_the_caller_answers_in_place_of_a_new_one(machine):
    with ThreadPoolExecutor(16) as pool:
        (first,) = {job.id for job in pool.map(lambda _: reused(machine), range(32))}
    others = [reused(machine, stated='{"wish": {}}'), reused(machine, caller=Holder(name="bench-3"))]
    assert len({first, *(job.id for job in others)}) == 3
    assert machine.submissions.counts() == {"accepted": 1}
    machine.submissions.dismiss(first)
    assert reused(machine).id != first


def test_a_job_answers_for_an_equal_one_as_long_as_it_has_or_will_have_a_result(machine, tmp_path):
    first = reused(machine)
    claim = machine.claimed()
    assert reused(machine).id == first.id
    machine.claims.fail(claim, "no mesh")
    second = reused(machine)
    assert second.id != first.id
    claim = machine.claimed()
    file = tmp_path / "made.nc"
    file.write_text("kept")
    machine.store.put(second.key, "database", file)
    machine.claims.succeed(claim)
    assert reused(machine).id == second.id
    machine.store.verified(second.key, "database").path.unlink()
    assert reused(machine).id != second.id


def test_a_claim_whose_commit_was_not_answered_is_the_same_claim(machine):
    """The connection broke after the commit: the step runs again and finds what it has done."""
    machine.submit(text="a")
    row = machine.claims._first()
    begin = Claims._begin.__wrapped__
    assert row is not None and begin(machine.claims, row) and begin(machine.claims, row)
    assert [claim.attempts for claim in machine.claims.running()] == [1]


def test_what_is_dismissed_while_it_is_claimed_is_not_run(machine):
    job = machine.submit(text="a")
    row = machine.claims._first()
    machine.submissions.dismiss(job.id)
    assert row is not None and not machine.claims._begin(row)
    assert machine.submissions.find(job.id).status == "dismissed"


def test_the_queue_is_bounded_but_lets_shared_work_in(machine):
    for text in "abc":
        machine.submit(text=text)
    with pytest.raises(QueueFull, match="3 computations wait already"):
        machine.submit(text="d")
    assert machine.submit(text="a").status == "accepted"
    machine.claimed()
    assert machine.submit(text="d").status == "accepted"


def test_stored_results_are_successful_at_once(machine, tmp_path):
    job = machine.submit(text="kept")
    file = tmp_path / "made.nc"
    file.write_text("kept")
    machine.store.put(job.key, "database", file)
    machine.submissions.dismiss(job.id)
    again = machine.submit(text="kept")
    assert (again.status, again.fraction, again.key) == ("successful", 1.0, job.key)


def test_work_that_ends_while_its_result_is_looked_for_is_not_done_again(machine):
    """The store did not have the result yet, and the table has the computation no more as running."""
    key, inputs = "ab" * 32, {"wish": {}}
    machine.submissions.submit("fake", key, inputs, stored=False)
    claim = machine.claimed()
    looked = now()
    machine.claims.succeed(claim)
    shared = machine.submissions.submit("fake", key, inputs, stored=False, looked=looked)
    assert shared.status == "successful"
    assert machine.submissions.counts() == {"successful": 1}
    lost = machine.submissions.submit("fake", key, inputs, stored=False)
    assert lost.status == "accepted"  # it ended before we looked, and its result is gone


def test_failed_work_may_be_tried_anew(machine):
    first = machine.submit(text="a")
    claim = machine.claimed()
    machine.claims.fail(claim, "no mesh")
    assert machine.submissions.find(first.id).status == "failed"
    assert machine.submit(text="a").status == "accepted"
    assert machine.submissions.find(first.id).status == "failed"


def test_dismissed_work_cannot_end_otherwise(machine):
    job = machine.submit(text="a")
    claim = machine.claimed()
    machine.submissions.dismiss(job.id)
    machine.reach(claim, 1.0, 1.0)
    machine.claims.succeed(claim)
    machine.claims.put_back(claim, "again", counted=True)
    assert machine.claims.still_running([claim]) == set()
    assert machine.submissions.find(job.id).status == "dismissed"
    assert machine.claims.claim() is None


def test_ended_jobs_stay_as_they_are(machine):
    job = machine.submit(text="a")
    claim = machine.claimed()
    machine.claims.succeed(claim)
    assert machine.submissions.dismiss(job.id).status == "successful"


def test_the_remaining_time_follows_the_pace_and_falls_between_reports(machine):
    job = machine.submit(text="a")
    assert machine.submissions.find(job.id).remaining_s(datetime.now(UTC)) is None
    claim = machine.claimed()
    machine.reach(claim, 0.5, 0.25)
    seen = machine.submissions.find(job.id)
    begun, updated = datetime.now(UTC) - timedelta(seconds=10), datetime.now(UTC)
    seen = replace(seen, started=instant(begun), updated=instant(updated))
    assert seen.remaining_s(updated) == pytest.approx(30.0, rel=1e-3)  # three times what a quarter took
    assert seen.remaining_s(updated + timedelta(seconds=4)) == pytest.approx(26.0, rel=1e-3)
    assert seen.remaining_s(updated + timedelta(seconds=99)) == pytest.approx(15.0, rel=1e-3)
    assert replace(seen, fraction=0.0).remaining_s(updated) is None
    assert replace(seen, attempts=2).remaining_s(updated) is None
    machine.claims.succeed(claim)
    assert machine.submissions.find(job.id).remaining_s(datetime.now(UTC)) is None


def test_pages_hold_every_job_once_the_newest_first(machine):
    jobs = [machine.submit(text="same").id for _ in range(7)]
    pages, after = [], None
    for _ in range(10):
        page = machine.submissions.page(3, after=after)
        if not page:
            break
        pages.append([job.id for job in page])
        after = Mark(page[-1].created, page[-1].id)
    assert [len(page) for page in pages] == [3, 3, 1]
    assert [identifier for page in pages for identifier in page] == jobs[::-1]


def test_an_unknown_job_is_said_to_be_unknown(machine):
    with pytest.raises(NoSuchJob, match="'nothing'"):
        machine.submissions.find("nothing")
    for odd in ("\x00", "\ud800", "a" * 36, str(uuid.uuid4())):
        with pytest.raises(NoSuchJob):
            machine.submissions.find(odd)


def test_jobs_survive_a_restart(machine, tmp_path):
    job = machine.submit(text="durable")
    again = bench(tmp_path, REGISTRY, database_url=machine.settings.database_address)
    assert again.submissions.find(job.id) == machine.submissions.find(job.id)
    again.close()


def test_a_callers_last_job_is_sought_among_its_own_alone(machine):
    """By the time of all jobs of a project those of others were read, at each submission."""
    if machine.engine.dialect.name != "sqlite":
        pytest.skip("a server plans by the numbers of its rows")
    plan: list[str] = []

    def explain(_connection, cursor, statement, parameters, *_):
        rows = cursor.connection.execute(f"EXPLAIN QUERY PLAN {statement}", parameters)
        plan.extend(str(row[3]) for row in rows)

    event.listen(machine.engine, "before_cursor_execute", explain)
    assert machine.submissions.newest(Holder(name="one"), "fake") is None
    assert "SEARCH job USING INDEX job_by_caller_and_time (caller=?)" in plan
