"""The live worker: one question at a time, an obsolete one stopped, and no death of it is for long."""

import json
import os
import signal
import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx2
import pytest
from own_process import children, command, python
from repository import ROOT
from running_service import PATIENCE_S, lives, until
from structlog.testing import capture_logs

from host.children.frames import Frame
from lineofaction.gearbox.problems import LiveUnavailable, ServiceError, Superseded, Unexpected
from service.live.answer import answer_of
from service.live.cached_answers import KeptAnswers
from service.live.live_worker import AnswerTimes, LiveWorker
from service.live.order import LiveOrder
from service.live.question_pool import QuestionPool
from service.live.turns import Asker, Limits
from service.version import modules_digest, program_tag

WORK = "live_fake_work"
GEAR = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
CASE = {
    "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [1.0]},
}


def order(name: str, **inputs: Any) -> LiveOrder:
    return LiveOrder(f"{WORK}:{name}", inputs)


def answer(future: Future[bytes]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(future.result(timeout=PATIENCE_S))
    return found


class LivePool(QuestionPool):
    def __init__(self, folder: Path, times: AnswerTimes | None = None, *, idle_s: float = 600.0) -> None:
        self.worker = LiveWorker(folder, 512, times)
        super().__init__([self.worker], Limits(in_all=4), "live requests", idle_s=idle_s)


@pytest.fixture
def pool(tmp_path):
    made = LivePool(tmp_path, AnswerTimes(obsolete_s=0.1))
    yield made
    made.stop()


def test_one_worker_answers_all_in_turn_and_is_nice(pool):
    first = answer(pool.ask(order("echo", word="a")))
    second = answer(pool.ask(order("echo", word="b")))
    assert (first["asked"], second["asked"]) == (["a"], ["a", "b"])
    assert first["pid"] == second["pid"] == pool.worker.pid != os.getpid()
    assert first["nice"] == min(os.nice(0) + 5, 19)


SLIDER = Asker(slider="slider")


def test_an_answer_that_becomes_obsolete_is_stopped_and_the_worker_goes_on(pool):
    first = answer(pool.ask(order("echo", word="a")))["pid"]
    running = pool.ask(order("hang"), SLIDER)
    until(running.running)
    newest = pool.ask(order("echo", word="newest"), SLIDER)
    with pytest.raises(Superseded):
        running.result(timeout=PATIENCE_S)
    found = answer(newest)
    assert (found["asked"], found["pid"]) == (["a", "newest"], first)  # it has lost nothing


def test_a_stop_breaks_off_no_import(pool):
    """Else a package stays half loaded, and every later question that needs it fails."""
    first = answer(pool.ask(order("echo", word="a")))["pid"]
    loading = pool.ask(order("load_slowly"), SLIDER)
    until(loading.running)
    newest = pool.ask(order("echo", word="newest"), SLIDER)
    assert answer(newest)["pid"] == first
    assert isinstance(loading.exception(timeout=PATIENCE_S), Superseded | None)
    assert answer(pool.ask(order("load_slowly"))) == {"attempts": 1}


def test_one_that_heeds_no_stop_is_killed(tmp_path):
    pool = LivePool(tmp_path, AnswerTimes(obsolete_s=0.1, to_stop_s=0.3))
    running = pool.ask(order("deaf"), SLIDER)
    until(running.running)
    newest = pool.ask(order("echo", word="newest"), SLIDER)
    with pytest.raises(Superseded):
        running.result(timeout=PATIENCE_S)
    assert answer(newest)["asked"] == ["newest"]
    pool.stop()


def test_no_stop_hits_what_comes_after_it(pool):
    """Each is made obsolete about when it ends: it has its answer or is stopped, the next one is answered."""
    for k in range(40):
        older = pool.ask(order("echo", word=f"older {k}", seconds=0.1 + 2.5e-4 * k), SLIDER)
        until(older.running)
        newer = pool.ask(order("echo", word=f"newer {k}"), SLIDER)
        assert answer(newer)["asked"][-1] == f"newer {k}"
        assert isinstance(older.exception(timeout=PATIENCE_S), Superseded | None)


def test_work_that_serves_the_newer_question_is_not_stopped(pool, tmp_path):
    gate = tmp_path / "gate"
    running = pool.ask(
        order("echo", word="bodies", wait_for=str(gate)), SLIDER, subject="a pair", lasting=True
    )
    until(running.running)
    newer = pool.ask(order("echo", word="curves"), SLIDER, subject="a pair")
    time.sleep(0.3)
    gate.touch()
    assert answer(running)["asked"] == ["bodies"]
    assert answer(newer)["asked"] == ["bodies", "curves"]


@pytest.mark.parametrize(("name", "text"), [("die", "ended. Repeat the request"), ("hog", "512 MB")])
def test_a_worker_that_died_is_replaced(pool, name, text):
    first = answer(pool.ask(order("echo", word="a")))["pid"]
    with pytest.raises(LiveUnavailable, match=text) as caught:
        pool.ask(order(name)).result(timeout=PATIENCE_S)
    assert (caught.value.status, caught.value.retry_after_s) == (503, 1)
    again = answer(pool.ask(order("echo", word="b")))
    assert again["asked"] == ["b"] and again["pid"] != first
    assert not lives(first)


def test_one_killed_in_the_middle_of_an_answer_is_told_and_those_that_wait_are_answered(pool, tmp_path):
    gate = tmp_path / "never"
    asked = pool.ask(order("echo", word="a", wait_for=str(gate)))
    waits = pool.ask(order("echo", word="b"))
    until(lambda: asked.running() and pool.worker.pid is not None)
    first = pool.worker.pid
    os.kill(first or 0, signal.SIGKILL)
    with pytest.raises(LiveUnavailable, match="ended"):
        asked.result(timeout=PATIENCE_S)
    assert answer(waits)["asked"] == ["b"]
    assert first is not None and not lives(first)


SERVE = """
import sys
from pathlib import Path
import service.routes.queries as live
from lineofaction.cli.serve import run_serve
live.PLAN = "live_fake_work:hang"
run_serve(data_directory=Path(sys.argv[1]), port=0)
"""


def _workers_of(service: int) -> list[int]:
    return [pid for pid in children(service) if b"live.child" in command(pid)]


def test_sigterm_in_the_middle_of_an_answer_ends_service_and_worker(tmp_path):
    """Long before the minute that an answer may take; whoever waits for it is told why there is none."""
    with python("-c", SERVE, tmp_path) as service:
        assert service.stdout is not None
        address = service.stdout.readline().split()[-1]
        with ThreadPoolExecutor(1) as pool, httpx2.Client(base_url=address, timeout=PATIENCE_S) as http:
            asked = pool.submit(http.post, "/v1/plans", json={"inputs": {"case": CASE}})
            workers: list[int] = []
            until(lambda: bool(workers.extend(_workers_of(service.pid)) or workers))
            service.send_signal(signal.SIGTERM)
            assert service.wait(timeout=PATIENCE_S) == 0
            refused = asked.result(timeout=PATIENCE_S)
            assert (refused.status_code, refused.json()["detail"]) == (503, "The service stops.")
    until(lambda: not any(lives(pid) for pid in workers))


def test_one_killed_between_two_questions_is_not_noticed(pool):
    first = answer(pool.ask(order("echo", word="a")))["pid"]
    os.kill(first, signal.SIGKILL)
    until(lambda: not lives(first))
    assert answer(pool.ask(order("echo", word="b")))["asked"] == ["b"]


def test_one_that_dies_unseen_after_an_answer_is_replaced_once(pool, monkeypatch):
    """A process whose threads still end looks alive when it is asked."""
    first = answer(pool.ask(order("echo", word="a")))["pid"]
    os.kill(first, signal.SIGKILL)
    until(lambda: not lives(first))
    monkeypatch.setattr("service.live.live_worker._LiveProcess.alive", True)
    assert answer(pool.ask(order("echo", word="b")))["pid"] != first


def test_what_takes_too_long_is_ended(tmp_path):
    pool = LivePool(tmp_path, AnswerTimes(longest_s=1.0))
    with capture_logs() as log, pytest.raises(LiveUnavailable, match="longer than 1 s"):
        pool.ask(order("hang")).result(timeout=PATIENCE_S)
    (pid,) = [entry["pid"] for entry in log if entry["event"] == "live worker started"]
    assert not lives(pid)
    pool.stop()


def test_an_idle_worker_ends_and_another_takes_the_next_question(tmp_path):
    pool = LivePool(tmp_path, idle_s=0.05)
    first = answer(pool.ask(order("echo", word="a")))["pid"]
    until(lambda: pool.worker.pid is None and not lives(first))
    assert answer(pool.ask(order("echo", word="b")))["asked"] == ["b"]
    pool.stop()


def test_a_stop_ends_the_worker_in_the_middle_of_an_answer(pool):
    asked, waits = pool.ask(order("hang")), pool.ask(order("echo", word="a"))
    until(lambda: asked.running() and pool.worker.pid is not None)
    pid = pool.worker.pid
    pool.stop()
    for future in (asked, waits):
        with pytest.raises(LiveUnavailable):
            future.result(timeout=PATIENCE_S)
    assert pid is not None and not lives(pid)


def test_a_refusal_passes_as_it_was_told_and_a_defect_by_number(pool, tmp_path):
    with pytest.raises(ServiceError) as caught:
        pool.ask(order("refuse")).result(timeout=PATIENCE_S)
    facts = caught.value.as_json()
    assert (facts["status"], facts["errors"][0]["field"]) == (422, "torque_n_m[0]")
    with pytest.raises(Unexpected) as unexpected:
        pool.ask(order("defect")).result(timeout=PATIENCE_S)
    assert "secret" not in str(unexpected.value)
    assert "secret" in (tmp_path / "log" / "live.log").read_text()


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
def test_a_number_that_json_has_not_is_a_defect(number):
    found = answer_of(LiveOrder("live_fake_work:speak", {"number": number}), note=lambda: None)
    assert found == Frame("defect")


def test_words_and_numbers_come_as_they_are():
    found = answer_of(LiveOrder("live_fake_work:speak", {"number": "0.3"}))
    expected = {"number": 0.3, "word": "NaN and Infinity", "list": [0.1, 1e-7, True, None, "µ"]}
    assert found.kind == "answer"
    assert found.as_json() == expected


SERVICE = """
import sys
from pathlib import Path
from service.live.live_worker import LiveWorker
from service.live.order import LiveOrder
from service.live.turns import Question
worker = LiveWorker(Path(sys.argv[1]), 512)
worker.answer(Question(LiveOrder("live_fake_work:echo", {"word": "a"})))
print("worker", worker.pid, flush=True)
worker.answer(Question(LiveOrder("live_fake_work:hang", {})))
"""


def test_kill_minus_nine_of_the_service_leaves_no_orphan(tmp_path):
    with python("-c", SERVICE, tmp_path) as service:
        assert service.stdout is not None
        line = next(line for line in service.stdout if line.startswith("worker "))
        worker = int(line.split()[1])
        assert lives(worker)
        service.kill()
    until(lambda: not lives(worker))


# Answers that are kept.


def test_what_is_kept_is_found_by_any_process_on_the_folder(tmp_path):
    folder = tmp_path / "figures"
    assert KeptAnswers(folder).find("a tag") is None
    KeptAnswers(folder).keep("a tag", b'{"title": "pair"}')
    assert KeptAnswers(folder).find("a tag") == b'{"title": "pair"}'
    assert KeptAnswers(folder).find("another tag") is None


def test_what_was_not_used_for_longest_goes_first(tmp_path):
    kept = KeptAnswers(tmp_path, max_bytes=250)
    for tag in ("first", "second"):
        kept.keep(tag, tag[:1].encode() * 100)
    for path in tmp_path.iterdir():  # long ago: what was used a moment ago stays
        os.utime(path, (1e9, 1e9))
    assert kept.find("first") == b"f" * 100
    kept.keep("third", b"t" * 100)
    assert kept.find("second") is None
    assert kept.find("first") is not None
    assert kept.find("third") is not None


def test_a_folder_that_cannot_be_written_keeps_nothing(tmp_path):
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    kept = KeptAnswers(tmp_path / "file")
    kept.keep("a tag", b"{}")
    assert kept.find("a tag") is None


def test_the_name_of_the_program_is_by_the_modules_of_its_tree_alone():
    assert program_tag().endswith(f"-{modules_digest(ROOT)}")


@pytest.mark.parametrize("package", ["service", "lineofaction", "host", "dynamics"])
def test_answers_of_an_edited_program_are_others(tmp_path, package):
    module = tmp_path / package / "report" / "content.py"
    module.parent.mkdir(parents=True)
    module.write_text("ROOM = 1\n", encoding="utf-8")
    before = modules_digest(tmp_path)
    assert modules_digest(tmp_path) == before
    module.write_text("ROOM = 2\n", encoding="utf-8")
    assert modules_digest(tmp_path) != before
