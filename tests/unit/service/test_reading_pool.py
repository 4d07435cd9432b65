"""Readers of foreign bytes: a child a question, shares by caller, limits that end it, nothing left behind."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import PATIENCE_S, lives, until
from service_fakes import REGISTRY
from structlog.testing import capture_logs

from lineofaction.gearbox.problems import (
    LiveUnavailable,
    QueueFull,
    ServiceError,
    TooLarge,
    TooManyHeld,
    Unexpected,
)
from service.app import create_app
from service.folders import own_folder, remove_left
from service.live.order import LiveOrder
from service.live.question_pool import QuestionPool
from service.live.turns import Asker
from service.reading.reader import AT_ONCE, LIMITS, reading_pool
from service.settings import Settings


def order(name: str, **inputs: Any) -> LiveOrder:
    return LiveOrder(f"reading_fake_work:{name}", inputs)


def answer(future: Future[bytes]) -> dict[str, Any]:
    return dict(json.loads(future.result(timeout=PATIENCE_S)))


def left(pool: QuestionPool) -> list[Path]:
    return list(pool._workers[0]._children._home.iterdir())


@pytest.fixture
def pool(tmp_path: Path) -> Iterator[QuestionPool]:
    made = reading_pool(tmp_path)
    yield made
    made.stop()


def test_each_question_has_a_process_and_a_folder_that_are_gone_after_it(pool: QuestionPool) -> None:
    answers = [answer(pool.ask(order("echo", word=word))) for word in "ab"]
    assert [found["word"] for found in answers] == ["a", "b"]
    assert len({found["pid"] for found in answers}) == len({found["folder"] for found in answers}) == 2
    assert not left(pool)


@pytest.mark.parametrize(
    ("name", "error", "text"),
    [
        ("refuse", ServiceError, "at most 4"),
        ("hog", TooLarge, "more than 512 MB of memory"),
        ("swell", ServiceError, "100000000 bytes"),
        ("die", LiveUnavailable, "ended"),
        ("defect", Unexpected, "unexpected failure"),
    ],
)
def test_a_question_that_fails_says_why_and_leaves_nothing(
    pool: QuestionPool, tmp_path: Path, name: str, error: type[ServiceError], text: str
) -> None:
    with pytest.raises(error, match=text):
        pool.ask(order(name, word="canary")).result(timeout=PATIENCE_S)
    assert not left(pool)
    assert "canary" not in "".join(file.read_text() for file in (tmp_path / "log").iterdir())


def test_cpu_time_ends_a_question_and_nobody_else_waits_for_it(
    pool: QuestionPool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three callers loop as long as they may; the fourth is answered before them."""
    looping = [pool.ask(order("loop"), Asker(f"caller {number}")) for number in range(AT_ONCE - 1)]
    begin = time.monotonic()
    assert answer(pool.ask(order("echo", word="honest"), Asker("honest")))["word"] == "honest"
    assert not any(future.done() for future in looping), time.monotonic() - begin
    pool.stop()
    for future in looping:
        with pytest.raises(LiveUnavailable, match="stops"):
            future.result(timeout=PATIENCE_S)
    assert not left(pool)


@pytest.mark.nightly
def test_ten_seconds_of_cpu_time_are_the_limit(pool: QuestionPool) -> None:
    with pytest.raises(TooLarge, match="more than 10 s of CPU time"):
        pool.ask(order("loop")).result(timeout=3 * PATIENCE_S)
    assert not left(pool)


def test_a_caller_has_one_read_and_one_waiting(pool: QuestionPool) -> None:
    futures = [pool.ask(order("echo", word=word, seconds=0.3), Asker("caller")) for word in "ab"]
    with pytest.raises(TooManyHeld) as refused:
        pool.ask(order("echo", word="c"), Asker("caller"))
    assert (refused.value.status, refused.value.retry_after_s) == (429, 1)
    assert not futures[1].running()
    assert [answer(future)["word"] for future in futures] == ["a", "b"]


def test_so_many_wait_and_no_more(pool: QuestionPool) -> None:
    many = LIMITS.in_all
    futures = [pool.ask(order("echo", word=str(n), seconds=0.2), Asker(f"caller {n}")) for n in range(many)]
    with pytest.raises(QueueFull):
        pool.ask(order("echo", word="too many"))
    assert [answer(future)["word"] for future in futures] == [str(number) for number in range(many)]


def test_a_killed_reader_leaves_nothing(pool: QuestionPool) -> None:
    answer(pool.ask(order("echo", word="warm")))
    future = pool.ask(order("loop"))
    readers = pool._workers[0]._children
    until(lambda: bool(readers._children) and bool(left(pool)) and any(left(pool)[0].iterdir()))
    (pid,) = readers._children
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(LiveUnavailable, match="ended"):
        future.result(timeout=PATIENCE_S)
    assert not left(pool) and not lives(pid)


def test_folders_of_a_killed_service_are_removed_and_no_others(tmp_path: Path) -> None:
    (tmp_path / "orphan").mkdir()
    (tmp_path / "orphan" / "file").touch()
    with own_folder(tmp_path) as used:
        remove_left(tmp_path)
        assert list(tmp_path.iterdir()) == [used]
    assert not list(tmp_path.iterdir())


def test_a_reader_sees_no_file_of_the_service(pool: QuestionPool, tmp_path: Path) -> None:
    (tmp_path / "keys.json").write_text("canary")
    with pytest.raises(Unexpected):
        pool.ask(order("peek", file=str(tmp_path / "keys.json"))).result(timeout=PATIENCE_S)


def test_a_system_that_confines_nothing_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("host.confinement._landlock", lambda: 0)
    with capture_logs() as log, TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY)) as http:
        ready = http.get("/ready", headers={"Host": "localhost"})
    assert ready.json()["missing_protections"] == ["files (Landlock)"]
    assert [entry["missing"] for entry in log if "confine" in entry["event"]] == [("files (Landlock)",)]
