"""Ctrl-C in Python keeps what is done: the draft of a table, the run so far, finished tasks."""

import signal
from typing import Any

import numpy as np
import pytest
from repository import EXAMPLES
from small_table import small_table

import lineofaction as loa
from dynamics.types import RunStatus
from lineofaction.gearbox.registry import STUDIES

CASE, SCENE = EXAMPLES / "palermo_spur_20_20.toml", EXAMPLES / "jeffcott_scene.toml"


@pytest.fixture(autouse=True)
def heeded(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupted_table_is_its_last_draft(monkeypatch):
    draft = small_table()

    def interrupted(_case, _home, _report, _workers, on_draft):
        on_draft(draft, "finer slices")
        raise KeyboardInterrupt

    monkeypatch.setattr("lineofaction.gearbox.workbench.database_of", interrupted)
    seen: list[str] = []
    with pytest.warns(loa.InputWarning, match="does not meet its tolerance"):
        assert loa.analyze(CASE, on_draft=lambda _table, text: seen.append(text)) is draft
    assert seen == ["finer slices"]


def test_without_a_draft_the_interrupt_goes_on(monkeypatch):
    def interrupted(*_request):
        raise KeyboardInterrupt

    monkeypatch.setattr("lineofaction.gearbox.workbench.database_of", interrupted)
    with pytest.raises(KeyboardInterrupt):
        loa.analyze(CASE)


def test_an_interrupted_run_ends_there():
    stages: list[str] = []

    def interrupting(stage, fraction):
        stages.append(stage)
        if stages.count("integration") == 1 and 0.0 < fraction < 1.0:
            signal.raise_signal(signal.SIGINT)

    with pytest.warns(loa.InputWarning, match=r"Interrupted: the run ends at \d"):
        run = loa.simulate(SCENE, interrupting)
    whole = loa.simulate(SCENE)
    assert run.status is RunStatus.CANCELLED and whole.status is RunStatus.COMPLETED
    assert 0 < run.time.size < whole.time.size
    half = run.time.size // 2  # the filter of the samples ends with the run
    assert np.array_equal(run.displacement[..., :half], whole.displacement[..., :half])


def test_a_second_interrupt_ends_the_work(monkeypatch):
    def twice(_stage, _fraction):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        loa.simulate(SCENE, twice)


def _replace_work(monkeypatch: pytest.MonkeyPatch, study: str, compute: Any) -> None:
    for name, function in {"compute": compute, "warnings": lambda _: None, "failure": lambda _: ""}.items():
        monkeypatch.setattr(STUDIES[study].run, name, function)


def test_a_search_ends_with_the_best_so_far(monkeypatch):
    best = object()

    def compute(_case, _inputs, means):
        assert not means.cancel()
        signal.raise_signal(signal.SIGINT)
        assert means.cancel()
        return best

    _replace_work(monkeypatch, "optimize", compute)
    with pytest.warns(loa.InputWarning, match="the best so far"):
        assert loa.optimize(CASE) is best


COMPUTED: list[int] = []
"""Tasks that were computed, not read from the cache."""


def _task(_shared: int, item: int) -> int:
    COMPUTED.append(item)
    return item


def test_finished_tasks_of_a_study_are_kept_for_the_same_call(monkeypatch):
    ends = [2, 4, 4]  # number of tasks that each call does before it ends

    def compute(_case, _inputs, means):
        end, results = ends.pop(0), []
        for result in means.workers.run(_task, 0, range(4)):
            results.append(result)
            if len(results) == end < 4:
                raise KeyboardInterrupt
        return results

    COMPUTED.clear()
    _replace_work(monkeypatch, "sweep", compute)
    with pytest.raises(KeyboardInterrupt):
        loa.sweep(CASE, over=["torque=10:20:10"])
    assert COMPUTED == [0, 1]
    assert loa.sweep(CASE, over=["torque=10:20:10"]) == [0, 1, 2, 3]
    assert COMPUTED == [0, 1, 2, 3]
    loa.sweep(CASE, over=["torque=10:20:10"])
    assert COMPUTED == [0, 1, 2, 3] * 2
