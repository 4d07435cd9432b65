"""Writers of one file take turns in the order in which they came, each within its patience."""

import time
from collections.abc import Callable
from threading import Event, Thread

import pytest
from running_service import until
from sqlalchemy import Engine, event

from lineofaction.gearbox.problems import Busy
from service.queue.tables import jobs
from service.store.database import open_database, writing
from service.store.retries import retried
from service.store.writers import TurnTimeout, WriterQueue, writers_of

WRITERS = 24


class Writer:
    """A user of a database that writes nothing, and holds it for a moment."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @retried
    def write(self, work: Callable[[], object], patience_ms: int | None = None) -> None:
        with writing(self._engine, patience_ms=patience_ms) as connection:
            connection.execute(jobs.delete().where(jobs.c.id == "none"))
            work()


def number_waiting(engine: Engine) -> int:
    return len(writers_of(str(engine.url.database))._waiting)


@pytest.mark.law
def test_writers_are_served_in_the_order_in_which_they_came(tmp_path):
    """SQLite alone lets in whoever tries when the file happens to be free.

    They wait with their connections open: opened within the turns these let half as many write in a time.
    """
    engine, served, release = open_database(tmp_path / "index.sqlite3"), list[int](), Event()
    opened = list[object]()
    event.listen(engine, "connect", lambda connection, _record: opened.append(connection))
    first = Thread(target=Writer(engine).write, args=(lambda: release.wait(60.0),))
    first.start()
    until(lambda: writers_of(str(engine.url.database))._occupied)
    threads = []
    for number in range(WRITERS):

        def work(number=number):
            served.append(number)
            time.sleep(0.005)

        threads.append(Thread(target=Writer(engine).write, args=(work,)))
        threads[-1].start()
        until(lambda number=number: number_waiting(engine) == number + 1)
    assert len(opened) == 1 + WRITERS
    release.set()
    for thread in (first, *threads):
        thread.join()
    assert served == list(range(WRITERS))
    engine.dispose()


def test_one_whose_turn_does_not_come_is_told_that_the_service_is_busy(machine):
    if machine.engine.dialect.name != "sqlite":
        pytest.skip("a server has many writers")
    writer = Writer(machine.engine)
    with writing(machine.engine):
        begin = time.monotonic()
        with pytest.raises(Busy) as caught:
            writer.write(lambda: None, patience_ms=200)
        assert 0.2 <= time.monotonic() - begin < 60.0
        assert (caught.value.status, caught.value.kind, caught.value.retry_after_s) == (503, "busy", 2)
    assert number_waiting(machine.engine) == 0
    writer.write(lambda: None, patience_ms=200)


def test_patience_is_one_in_the_queue_and_at_the_file():
    queue, left = WriterQueue(), list[float]()

    def wait():
        with queue.turn(60.0) as left_s:
            left.append(left_s)

    with queue.turn(60.0) as whole:
        thread = Thread(target=wait)
        thread.start()
        time.sleep(0.2)
    thread.join()
    assert whole == pytest.approx(60.0, abs=0.1)
    assert left[0] < 59.9


def test_one_that_gives_up_leaves_its_place_and_one_ahead_is_the_next():
    queue, served = WriterQueue(), list[str]()

    def wait(name, ahead):
        with queue.turn(60.0, ahead=ahead):
            served.append(name)

    threads = [Thread(target=wait, args=(name, name == "ahead")) for name in ("one", "other", "ahead")]
    with queue.turn(1.0):
        with pytest.raises(TurnTimeout), queue.turn(0.01):
            pass
        for number, thread in enumerate(threads):
            thread.start()
            until(lambda number=number: len(queue._waiting) == number + 1)
    for thread in threads:
        thread.join()
    assert served == ["ahead", "one", "other"]
    with queue.turn(0.0) as left_s:
        assert left_s == 0.0


def test_a_turn_that_ends_by_an_error_is_given_on():
    queue = WriterQueue()
    with pytest.raises(ValueError, match="defect"), queue.turn(1.0):
        raise ValueError("defect")
    with queue.turn(0.0):
        pass
