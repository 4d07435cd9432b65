"""The watcher of jobs: all followers get every state at the cost of one, and an outage is outlasted."""

import threading
from contextlib import ExitStack

import pytest
from running_service import bench, until
from service_fakes import REGISTRY
from sqlalchemy import delete, event

from service.queue import watcher as watching
from service.queue.job import Job
from service.queue.tables import jobs
from service.queue.watcher import Watcher
from service.store.database import database_engine, writing


@pytest.fixture
def watcher(machine, monkeypatch):
    """A watcher as of another process: it has connections of its own, and looks when it hears alone."""
    monkeypatch.setattr(watching, "NET_S", 1e6)
    engine = database_engine(machine.settings.database_address or machine.settings.data_directory / FILE)
    found = Watcher(engine, lambda job: job)
    yield found
    found.stop()
    engine.dispose()


FILE = "service.sqlite3"


def test_every_follower_gets_every_state_in_order(machine, watcher):
    job, received = machine.submit(text="a"), [list[Job | None]() for _ in range(5)]
    with ExitStack() as following:
        for each in received:
            following.enter_context(watcher.following(job, each.append))
        claim = machine.claimed()
        until(lambda: all(each for each in received))
        for fraction in (0.2, 0.4):
            machine.reach(claim, fraction, fraction)
            until(lambda fraction=fraction: all(_fraction(each) == fraction for each in received))
        machine.claims.succeed(claim)
        until(lambda: all(_status(each) == "successful" for each in received))
    for each in received:
        states = [(state.status, state.fraction) for state in each if state is not None]
        assert states == [("running", 0.0), ("running", 0.2), ("running", 0.4), ("successful", 1.0)]


def _fraction(received: list[Job | None]) -> float:
    return received[-1].fraction if received and received[-1] is not None else -1.0


def _status(received: list[Job | None]) -> str:
    return received[-1].status if received and received[-1] is not None else ""


def test_a_state_that_was_reached_before_anybody_followed_is_reported(machine, watcher):
    job = machine.submit(text="a")
    machine.claims.succeed(machine.claimed())
    received: list[Job | None] = []
    with watcher.following(job, received.append):
        until(lambda: _status(received) == "successful")
    assert _status(received) == "successful"


def test_a_job_that_waits_is_reported_as_its_turn_comes(machine, watcher):
    machine.submit(text="a")
    job = machine.submit(text="b")
    received: list[Job | None] = []
    with watcher.following(job, received.append):
        claim = machine.claimed()
        machine.claims.succeed(claim)
        until(lambda: received and received[-1] is not None and received[-1].ahead == 0)
    assert {state.mark for state in received if state} == {job.updated + "/0"}


def test_a_dismissal_is_reported_to_those_of_that_job_alone(machine, watcher):
    mine, other = machine.submit(text="same"), machine.submit(text="same")
    received: list[Job | None] = []
    others: list[Job | None] = []
    with watcher.following(mine, received.append), watcher.following(other, others.append):
        machine.submissions.dismiss(mine.id)
        until(lambda: _status(received) == "dismissed")
        machine.claimed()
        until(lambda: _status(others) == "running")
    assert [_status([state]) for state in others] == ["running"]


def test_two_hundred_followers_cost_the_questions_of_one(machine, watcher):
    pair, claims = [machine.submit(text=text) for text in "ab"], [machine.claimed() for _ in range(2)]
    heard = threading.Semaphore(0)
    received: list[Job | None] = []
    statements: list[str] = []
    with ExitStack() as following:
        for number in range(200):
            following.enter_context(watcher.following(pair[number % 2], lambda _: heard.release()))
        following.enter_context(watcher.following(pair[0], received.append))
        until(lambda: _status(received) == "running")  # everything before is received by now
        event.listen(watcher._engine, "before_cursor_execute", lambda *words: statements.append(words[2]))
        while heard.acquire(blocking=False):
            pass
        for claim in claims:
            machine.claims.succeed(claim)
        for _ in range(200):
            assert heard.acquire(timeout=60.0)
    assert sum("coalesce" in statement for statement in statements) <= 4
    assert sum("computation.inputs" in statement for statement in statements) <= 2


def test_what_is_not_heard_is_seen(machine, watcher, monkeypatch):
    deaf = type(
        "Deaf", (), {"received": lambda self: bool(threading.Event().wait(0.02)), "close": lambda self: None}
    )
    monkeypatch.setattr(watching, "NET_S", 0.1)
    monkeypatch.setattr(
        watching, "dialect_of", lambda _: type("None", (), {"commits": lambda self, _: deaf()})()
    )
    job, received = machine.submit(text="a"), list[Job | None]()
    with watcher.following(job, received.append):
        machine.claimed()
        until(lambda: _status(received) == "running")
        machine.submissions.dismiss(job.id)
        until(lambda: _status(received) == "dismissed")
    assert _status(received) == "dismissed"


def test_a_job_that_is_removed_ends_its_streams(machine, watcher):
    job, received = machine.submit(text="a"), list[Job | None]()
    with watcher.following(job, received.append):
        with writing(machine.engine) as connection:
            connection.execute(delete(jobs).where(jobs.c.id == job.id))
        until(lambda: received[-1:] == [None])  # it may have been seen before it was removed
    assert received.count(None) == 1


def test_without_followers_there_is_no_thread(machine, watcher):
    job = machine.submit(text="a")
    for _ in range(2):
        with watcher.following(job, lambda _: None):
            assert watcher._thread is not None
        until(lambda: watcher._thread is None)


def test_a_stop_tells_all_who_follow(machine, watcher):
    received: list[Job | None] = []
    with watcher.following(machine.submit(text="a"), received.append):
        watcher.stop()
        assert received == [None]


@pytest.mark.law
def test_lost_connections_lose_no_state(postgres, tmp_path, monkeypatch):
    monkeypatch.setattr(watching, "NET_S", 1e6)  # by what is heard, or after the loss, alone
    url = postgres.emptied_database()
    machine = bench(tmp_path, REGISTRY, database_url=url)
    engine = database_engine(url)
    watcher, received = Watcher(engine, lambda job: job), list[Job | None]()
    try:
        with watcher.following(machine.submit(text="a"), received.append):
            claim = machine.claimed()
            until(lambda: _status(received) == "running")
            assert postgres.end_connections(url) > 0
            machine.reach(claim, 0.5, 0.5)
            until(lambda: _fraction(received) == 0.5)
            postgres.fall_and_rise(0.2)
            machine.claims.succeed(claim)
            until(lambda: _status(received) == "successful")
    finally:
        watcher.stop()
        engine.dispose()
        machine.close()
