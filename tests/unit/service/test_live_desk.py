"""The live worker: one question at a time, the newest of a caller wins, and no death of it is for long."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from running_service import lives, until

from service.jobs.live_desk import LiveDesk, LiveLimits
from service.jobs.live_order import LiveOrder
from service.problems import LiveUnavailable, QueueFull, ServiceError, Superseded, Unexpected

WORK = "live_stand_in_work"


def order(name: str, **inputs: Any) -> LiveOrder:
    return LiveOrder(f"{WORK}:{name}", inputs)


def answer(future: Future[bytes]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(future.result(timeout=60.0))
    return found


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[LiveDesk]:
    made = LiveDesk(tmp_path, 512, LiveLimits(waiting=3))
    yield made
    made.stop()


def test_one_worker_answers_all_in_turn_and_is_nice(desk: LiveDesk) -> None:
    first = answer(desk.ask(order("echo", word="a")))
    second = answer(desk.ask(order("echo", word="b")))
    assert (first["asked"], second["asked"]) == (["a"], ["a", "b"])
    assert first["pid"] == second["pid"] == desk.worker_pid != os.getpid()
    assert first["nice"] == min(os.nice(0) + 5, 19)


def test_the_newest_question_of_a_caller_wins(desk: LiveDesk, tmp_path: Path) -> None:
    gate = tmp_path / "gate"
    running = desk.ask(order("echo", word="runs", wait_for=str(gate)), "slider")
    until(running.running)
    obsolete = desk.ask(order("echo", word="obsolete"), "slider")
    other = desk.ask(order("echo", word="other"), "form")
    newest = desk.ask(order("echo", word="newest"), "slider")
    with pytest.raises(Superseded):
        obsolete.result(timeout=60.0)
    gate.touch()
    assert answer(running)["asked"] == ["runs"]
    assert answer(other)["asked"][1:] in (["other"], ["newest", "other"])
    assert sorted(answer(newest)["asked"] + ["other"])[:1] == ["newest"]


def test_the_queue_is_bounded_and_says_when_to_ask_again(desk: LiveDesk, tmp_path: Path) -> None:
    gate = tmp_path / "gate"
    running = desk.ask(order("echo", word="runs", wait_for=str(gate)))
    until(running.running)
    waiting = [desk.ask(order("echo", word=str(k)), f"caller {k}") for k in range(3)]
    with pytest.raises(QueueFull) as caught:
        desk.ask(order("echo", word="one too many"))
    assert (caught.value.status, caught.value.retry_after_s) == (429, 1)
    replaced = desk.ask(order("echo", word="instead"), "caller 0")
    gate.touch()
    assert answer(replaced)["asked"][0] == "runs"
    assert [answer(future)["asked"][-1] for future in waiting[1:]] == ["1", "2"]


@pytest.mark.parametrize(("name", "text"), [("die", "ended. Ask again"), ("hog", "512 MB")])
def test_a_worker_that_died_is_replaced(desk: LiveDesk, name: str, text: str) -> None:
    first = answer(desk.ask(order("echo", word="a")))["pid"]
    with pytest.raises(LiveUnavailable, match=text) as caught:
        desk.ask(order(name)).result(timeout=60.0)
    assert (caught.value.status, caught.value.retry_after_s) == (503, 1)
    again = answer(desk.ask(order("echo", word="b")))
    assert again["asked"] == ["b"] and again["pid"] != first
    assert not lives(first)


def test_one_killed_between_two_questions_is_not_noticed(desk: LiveDesk) -> None:
    first = answer(desk.ask(order("echo", word="a")))["pid"]
    os.kill(first, signal.SIGKILL)
    until(lambda: not lives(first))
    assert answer(desk.ask(order("echo", word="b")))["asked"] == ["b"]


def test_one_that_dies_unseen_after_an_answer_is_replaced_once(
    desk: LiveDesk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process whose threads still end looks alive when it is asked."""
    first = answer(desk.ask(order("echo", word="a")))["pid"]
    os.kill(first, signal.SIGKILL)
    until(lambda: not lives(first))
    monkeypatch.setattr("service.jobs.live_worker.LiveWorker.alive", True)
    assert answer(desk.ask(order("echo", word="b")))["pid"] != first


def test_what_takes_too_long_is_ended(tmp_path: Path) -> None:
    desk = LiveDesk(tmp_path, 512, LiveLimits(answer_s=1.0))
    pid = []
    late = desk.ask(order("hang"))
    until(lambda: desk.worker_pid is not None)
    pid.append(desk.worker_pid)
    with pytest.raises(LiveUnavailable, match="longer than 1 s"):
        late.result(timeout=60.0)
    until(lambda: not lives(pid[0] or 0))
    desk.stop()


def test_an_idle_worker_ends_and_another_takes_the_next_question(tmp_path: Path) -> None:
    desk = LiveDesk(tmp_path, 512, LiveLimits(idle_s=0.05))
    first = answer(desk.ask(order("echo", word="a")))["pid"]
    until(lambda: desk.worker_pid is None and not lives(first))
    assert answer(desk.ask(order("echo", word="b")))["asked"] == ["b"]
    desk.stop()


def test_a_stop_ends_the_worker_in_the_middle_of_an_answer(desk: LiveDesk) -> None:
    asked, waits = desk.ask(order("hang")), desk.ask(order("echo", word="a"))
    until(lambda: asked.running() and desk.worker_pid is not None)
    pid = desk.worker_pid
    desk.stop()
    for future in (asked, waits):
        with pytest.raises(LiveUnavailable):
            future.result(timeout=60.0)
    assert pid is not None and not lives(pid)


def test_a_refusal_passes_as_it_was_told_and_a_defect_by_number(desk: LiveDesk, tmp_path: Path) -> None:
    with pytest.raises(ServiceError) as caught:
        desk.ask(order("refuse")).result(timeout=60.0)
    facts = caught.value.as_json()
    assert (facts["status"], facts["errors"][0]["field"]) == (422, "torque_n_m[0]")
    with pytest.raises(Unexpected) as unexpected:
        desk.ask(order("defect")).result(timeout=60.0)
    assert "secret" not in str(unexpected.value)
    assert "secret" in (tmp_path / "log" / "live.log").read_text()


SERVICE = """
import sys
from pathlib import Path
from service.jobs.live_desk import LiveDesk
from service.jobs.live_order import LiveOrder
desk = LiveDesk(Path(sys.argv[1]), 512)
desk.ask(LiveOrder("live_stand_in_work:echo", {"word": "a"})).result()
print("worker", desk.worker_pid, flush=True)
desk.ask(LiveOrder("live_stand_in_work:hang", {})).result()
"""


def test_kill_minus_nine_of_the_service_leaves_no_orphan(tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(root), os.environ["PYTHONPATH"]])}
    command = [sys.executable, "-c", SERVICE, str(tmp_path)]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as service:
        assert service.stdout is not None
        line = next(line for line in service.stdout if line.startswith("worker "))
        worker = int(line.split()[1])
        assert lives(worker)
        service.kill()
    until(lambda: not lives(worker))
