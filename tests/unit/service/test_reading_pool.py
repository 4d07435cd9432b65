"""Readers of foreign bytes: a child a question, shares by caller, limits that end it, nothing left behind."""

import json
import os
import signal
import time
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import PATIENCE_S, lives, until
from service_fakes import REGISTRY
from structlog.testing import capture_logs

from host import Ended
from host.children.frames import Frame, FrameBuffer
from lineofaction.cli.serve import run_serve
from lineofaction.gearbox.problems import (
    BadInput,
    LiveUnavailable,
    QueueFull,
    ServiceError,
    TooManyHeld,
    Unexpected,
)
from service.app import create_app
from service.folders import locked_folder, remove_left
from service.live.order import LiveOrder
from service.live.question_pool import QuestionPool
from service.live.turns import Asker, Question
from service.reading.course import Course
from service.reading.reader import AT_ONCE, LIMITS, reading_pool
from service.settings import Settings, load_settings

READING_BEGUN = Frame("reading").head


def order(name: str, **inputs: Any) -> LiveOrder:
    return LiveOrder(f"reading_fake_work:{name}", inputs)


def answer(future: Future[bytes]) -> dict[str, Any]:
    return dict(json.loads(future.result(timeout=PATIENCE_S)))


def left(pool: QuestionPool) -> list[Path]:
    return list(pool._workers[0]._children._home.iterdir())


@pytest.fixture
def pool(tmp_path):
    made = reading_pool(tmp_path)
    yield made
    made.stop()


def test_each_question_has_a_process_and_a_folder_that_are_gone_after_it(pool):
    answers = [answer(pool.ask(order("echo", word=word))) for word in "ab"]
    assert [found["word"] for found in answers] == ["a", "b"]
    assert len({found["pid"] for found in answers}) == len({found["folder"] for found in answers}) == 2
    assert not left(pool)


@pytest.mark.parametrize(
    ("name", "error", "text"),
    [
        ("refuse", ServiceError, "at most 4"),
        ("hog", BadInput, "within 512 MB of memory"),
        ("swell", ServiceError, "100000000 bytes"),
        ("die", BadInput, r"ended its reader \(SIGSEGV\)"),
        ("leave", BadInput, r"ended its reader \(exit code 3\)"),
        ("fill", BadInput, "without more than 400 MB written"),
        ("scatter", BadInput, "without more than 100 files written"),
        ("defect", Unexpected, "unexpected failure"),
    ],
)
def test_a_question_that_fails_says_why_and_leaves_nothing(pool, tmp_path, name, error, text):
    with pytest.raises(error, match=text):
        pool.ask(order(name, word="canary")).result(timeout=PATIENCE_S)
    assert not left(pool)
    assert "canary" not in "".join(file.read_text() for file in (tmp_path / "log").iterdir())


FILES = [{"name": f"{letter}.step", "content": letter} for letter in "abc"]
HOUSINGS = [{"step_file": file} for file in FILES]


@pytest.mark.parametrize(
    ("inputs", "announced", "field", "value"),
    [
        ({"housings": HOUSINGS}, ["housings[0].step_file"], "housings[0].step_file", "a.step"),
        ({"housings": HOUSINGS}, ["housings[0].step_file", "housings[1].step_file"],
         "housings[1].step_file", "b.step"),
        ({"toml": "[pair]", "files": FILES}, [], "toml", "[pair]"),
        ({"toml": "[pair]", "files": FILES}, ["files[2]"], "files[2]", "c.step"),
        ({"rexs_base64": "A" * 100}, ["/etc/passwd"], "rexs_base64", "A" * 20),
        ({"measured": {"csv": "tooth,"}}, [], "measured.csv", "tooth,"),
    ],
)  # fmt: skip
def test_a_file_that_ends_its_reader_is_named(pool, inputs, announced, field, value):
    """Not by what the reader says it reads, unless that was sent."""
    with pytest.raises(BadInput) as refused:
        pool.ask(order("die_at", fields=announced, **inputs)).result(timeout=PATIENCE_S)
    (fault,) = refused.value.faults
    assert (refused.value.status, fault.field, fault.value) == (422, field, value)
    assert fault.bound.endswith("(SIGSEGV)") and fault.suggestion


@pytest.mark.parametrize(
    ("sent", "code", "cpu_seconds", "bound"),
    [
        (READING_BEGUN, -signal.SIGABRT, 0.1, "SIGABRT"),
        (READING_BEGUN, -signal.SIGXCPU, 10.0, "10 s of CPU time"),
        (READING_BEGUN, -signal.SIGKILL, 11.0, "10 s of CPU time"),
        (READING_BEGUN, -signal.SIGALRM, 0.0, "30 s"),
        (READING_BEGUN + b'{"kind": "answer", "length": 9}\n{', 0, 0.0, "exit code 0"),
        (READING_BEGUN + b"\xff\n", 0, 0.0, "exit code 0"),
        (READING_BEGUN, -signal.SIGKILL, 1.0, ""),
        (b"", -signal.SIGSEGV, 0.1, ""),
        (b"", 1, 0.1, ""),
    ],
)
def test_ends_that_are_not_the_files_fault_may_be_repeated(sent, code, cpu_seconds, bound):
    """A kill from outside, and an end before the order was read."""
    course, frames = Course(), FrameBuffer()
    course.take(frames.take(sent))
    course.end(partial=frames.partial)
    found = course.bound_of_end(Ended(code, cpu_seconds, 0))
    assert bound in found and bool(bound) == bool(found)


def test_cpu_time_ends_a_question_and_nobody_else_waits_for_it(pool, monkeypatch):
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


def test_a_service_that_has_ended_starts_no_reader_until_it_starts_again(tmp_path):
    app = create_app(Settings(data_directory=tmp_path), REGISTRY)
    reader = app.state.context.reader
    for word in "ab":
        with TestClient(app):
            assert answer(reader.ask(order("echo", word=word)))["word"] == word
        with pytest.raises(LiveUnavailable, match="stops"):
            reader.ask(order("echo", word="late"))
        with pytest.raises(LiveUnavailable, match="stops"):  # a question that was on its way to a reader
            reader._workers[0].answer(Question(order("echo", word="late"), Asker()))
        assert not left(reader)


@pytest.mark.nightly
def test_ten_seconds_of_cpu_time_are_the_limit(pool):
    with pytest.raises(BadInput, match="read within 10 s of CPU time"):
        pool.ask(order("loop")).result(timeout=3 * PATIENCE_S)
    assert not left(pool)


def test_a_caller_has_one_read_and_one_waiting(pool):
    futures = [pool.ask(order("echo", word=word, seconds=0.3), Asker("caller")) for word in "ab"]
    with pytest.raises(TooManyHeld) as refused:
        pool.ask(order("echo", word="c"), Asker("caller"))
    assert (refused.value.status, refused.value.retry_after_s) == (429, 1)
    assert not futures[1].running()
    assert [answer(future)["word"] for future in futures] == ["a", "b"]


def test_so_many_wait_and_no_more(pool):
    many = LIMITS.in_all
    futures = [pool.ask(order("echo", word=str(n), seconds=0.2), Asker(f"caller {n}")) for n in range(many)]
    with pytest.raises(QueueFull):
        pool.ask(order("echo", word="too many"))
    assert [answer(future)["word"] for future in futures] == [str(number) for number in range(many)]


def test_a_killed_reader_leaves_nothing(pool):
    answer(pool.ask(order("echo", word="warm")))
    future = pool.ask(order("loop"))
    readers = pool._workers[0]._children
    until(lambda: bool(readers._children) and bool(left(pool)) and any(left(pool)[0].iterdir()))
    (child,) = readers._children
    pid = child.pid
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(LiveUnavailable, match="ended"):
        future.result(timeout=PATIENCE_S)
    assert not left(pool) and not lives(pid)


def test_folders_of_a_killed_service_are_removed_and_no_others(tmp_path):
    (tmp_path / "orphan").mkdir()
    (tmp_path / "orphan" / "file").touch()
    with locked_folder(tmp_path) as used:
        remove_left(tmp_path)
        assert list(tmp_path.iterdir()) == [used]
    assert not list(tmp_path.iterdir())


def test_a_reader_sees_no_file_of_the_service(pool, tmp_path):
    (tmp_path / "keys.json").write_text("canary")
    with pytest.raises(Unexpected):
        pool.ask(order("peek", file=str(tmp_path / "keys.json"))).result(timeout=PATIENCE_S)


def test_a_system_that_confines_nothing_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr("host.confinement.landlock_version", lambda: 0)
    with capture_logs() as log, TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY)) as http:
        ready = http.get("/ready", headers={"Host": "localhost"})
    assert ready.json()["missing_protections"] == ["files (Landlock)"]
    assert [entry["missing"] for entry in log if "confine" in entry["event"]] == [("files (Landlock)",)]


def test_a_service_that_requires_confinement_does_not_start_without(tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_REQUIRE_CONFINEMENT", "true")
    settings = load_settings(data_directory=tmp_path)
    create_app(settings, REGISTRY)
    monkeypatch.setattr("host.confinement.filters_calls", lambda: False)
    monkeypatch.setattr("host.confinement.landlock_version", lambda: 0)
    with pytest.raises(BadInput) as refused:
        run_serve(data_directory=tmp_path / "other")
    (fault,) = refused.value.faults
    assert fault.field == "require_confinement"
    assert "files (Landlock), system calls (seccomp)" in fault.bound
    with pytest.raises(BadInput, match="lacks protections"):
        create_app(settings, REGISTRY)
