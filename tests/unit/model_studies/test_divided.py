"""Work that is divided where that pays: who does it, its errors, its end by a cancel or a kill."""

import os
import re
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import active_children
from typing import Any

import pytest
from running_service import until

from host import MissingExtra, cpu_seconds
from model_studies import LeftOut, run_variants
from model_studies.workers import (
    ByExecutor,
    InProcess,
    RunCost,
    WorkersLost,
    dispatch,
    divided,
    local_processes,
    pays,
    spent,
)


@dataclass(frozen=True)
class Noting:
    """Workers that note what they are sent."""

    cost: RunCost = field(default_factory=RunCost)
    sent: list[Any] = field(default_factory=list)

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        self.sent.extend(items)
        return (function(shared, item) for item in items)


def burned(_: None, seconds: float) -> float:
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass
    return seconds


@pytest.mark.parametrize(
    ("items", "seconds", "sent"),
    [
        ([0.0, 0.0, 0.0], None, 0),  # nothing costs anything
        ([0.05, 0.0, 0.0], None, 0),  # the first loads code
        ([0.0, 0.03, 0.03, 0.03, 0.03, 0.03], None, 4),
        ([0.0, 0.0, 0.0, 0.06, 0.06, 0.06], None, 2),  # where it gets dear
        ([0.0, 0.0, 0.0, 0.12, 0.12], None, 0),  # a single one left
        ([0.0, 0.0, 0.0], 0.2, 3),
        ([0.1, 0.1, 0.1], 0.05, 0),
        ([0.0], 99.0, 0),
        ([], 99.0, 0),
    ],
)
def test_only_work_that_takes_longer_than_a_process_starts_is_sent(items, seconds, sent, monkeypatch):
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.1)
    workers = Noting()
    assert list(divided(workers, burned, None, items, seconds)) == items
    assert workers.sent == items[len(items) - sent :]


def test_workers_that_are_awake_take_less(monkeypatch):
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.2)
    monkeypatch.setattr(dispatch, "AWAKE", 0.25)
    for tasks, sent in ((0, 0), (1, 3)):
        workers = Noting(RunCost(tasks))
        assert list(divided(workers, burned, None, [0.0, 0.0, 0.0], 0.1)) == [0.0, 0.0, 0.0]
        assert len(workers.sent) == sent
        assert pays(workers, 0.1) is (tasks > 0) and pays(workers, 0.3) and not pays(workers, 0.01)
    assert not pays(InProcess(), 99.0)


def test_time_of_the_caller_between_results_is_no_time_of_tasks(monkeypatch):
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.1)
    workers = Noting()
    for _ in divided(workers, burned, None, [0.0] * 4):
        burned(None, 0.1)
    assert not workers.sent


def test_what_was_spent_has_the_tasks_of_workers():
    with ThreadPoolExecutor(1) as executor:
        workers, before = ByExecutor(executor), cpu_seconds()
        assert list(workers.run(burned, None, [0.2])) == [0.2]
        assert spent(workers) - before > cpu_seconds() - before + 0.15
    assert spent(InProcess()) == pytest.approx(cpu_seconds(), abs=0.1)


# A pool of this machine.


@pytest.fixture(autouse=True)
def always(monkeypatch):
    """Send everything, whatever it costs."""
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)


class Unsolved(Exception):
    """What a library raises."""


def solved(variant: str) -> tuple[str, int]:
    errors = {"unsolved": Unsolved("no equilibrium"), "said": LeftOut("it is even"), "large": MemoryError()}
    if variant in errors:
        raise errors[variant]
    if variant == "defect":
        raise ZeroDivisionError("in a task")
    return variant, os.getpid()


def variants(*names: str) -> dict[str, str]:
    return {name: name for name in names}


def test_variants_by_a_pool_have_results_reasons_and_errors_as_here():
    names = variants("one", "unsolved", "two", "said", "large", "three")
    seen: list[tuple[str, float]] = []
    with local_processes(2) as pool:
        results, left_out = run_variants(
            "count", names, solved, (Unsolved,), lambda *step: seen.append(step), pool, 1.0
        )
        assert pool.cost.tasks == 6
        errors = []
        for workers in (InProcess(), pool):
            with pytest.raises(ZeroDivisionError) as caught:
                run_variants("count", variants("one", "defect"), solved, (), lambda *_: None, workers, 1.0)
            errors.append(caught.value.args)
    here = run_variants("count", names, solved, (Unsolved,), lambda *_: None)
    assert [name for name, _ in results.values()] == list(results) == list(here[0]) == ["one", "two", "three"]
    assert os.getpid() not in [pid for _, pid in results.values()]
    assert (
        left_out == here[1] == {"unsolved": "no equilibrium", "said": "it is even", "large": "out of memory"}
    )
    assert [fraction for _, fraction in seen] == pytest.approx([k / 6 for k in range(7)])
    assert errors[0] == errors[1] == ("in a task",)


def test_what_is_missing_there_is_missing_here_by_the_same_error():
    missing = MissingExtra("ngsolve", "boundary-elements")
    with local_processes(1) as pool, pytest.raises(MissingExtra, match=re.escape(str(missing))) as caught:
        list(pool.run(refused, missing, [1]))
    assert vars(caught.value)["extra"] == "boundary-elements" and caught.value.name == "ngsolve"


def refused(error: Exception, _: int) -> None:
    raise error


def long(_: None, seconds: float) -> None:
    time.sleep(seconds)


def test_workers_end_at_once_when_the_caller_stops():
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), local_processes(2) as pool:
        for _ in divided(pool, long, None, [0.0, 60.0, 60.0, 60.0], 9.0):
            raise KeyboardInterrupt
    assert time.monotonic() - begun < 30.0
    assert not active_children()


def killed(caller: int, item: int) -> int:
    if item and os.getpid() != caller:
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def test_a_killed_worker_ends_the_study_and_nothing_hangs():
    with pytest.raises(WorkersLost, match="1 of 3 tasks were done"), local_processes(1) as pool:
        list(divided(pool, killed, os.getpid(), [0, 1, 1], 9.0))
    until(lambda: not active_children())
