"""What predictions of a run's time know of the host: its speed, and the log of earlier runs."""

import json
import math
import os

import numpy as np
import pytest

from fe_contact import Gear
from fe_contact.compliance import condensation_cost
from fe_contact.compliance.condensation_cost import MESH_SECONDS, predict_cost
from model_studies import host_speed
from model_studies.host_speed import FILE, algebra_threads, cached_speed, host_slowness, quickest
from model_studies.run_log import FILE as LOG
from model_studies.run_log import LAST, corrections, record


def test_the_speed_of_the_host_is_kept(tmp_path, monkeypatch):
    first = host_slowness(tmp_path)
    assert 0.001 <= first <= 1000.0
    monkeypatch.setattr(host_speed, "measured_slowness", lambda: pytest.fail("measured again"))
    assert host_slowness(tmp_path) == first


def test_one_file_keeps_all_speeds(tmp_path):
    first = [cached_speed(tmp_path, name, lambda: 2.0, (1.0, 3.0)) for name in ("a", "b")]
    again = [cached_speed(tmp_path, name, lambda: pytest.fail("measured"), (1.0, 3.0)) for name in ("a", "b")]
    assert first == again == [2.0, 2.0]


def test_the_rate_of_dense_algebra_is_that_of_as_many_threads(tmp_path, monkeypatch):
    """Threads that wait for each other take CPU time; what one process measured is not another's price."""
    rates = iter([2e10, 1e10])
    monkeypatch.setattr(condensation_cost, "_dense_rate", lambda: next(rates))
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    gear = Gear(teeth=20, normal_module=2e-3, face_width=8e-3, bore_diameter=20e-3)
    seconds = []
    for threads in ("1", "2", "1"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        seconds.append(predict_cost(gear, cache=tmp_path).seconds - MESH_SECONDS)
    assert seconds[0] == seconds[2] and seconds[1] == pytest.approx(2.0 * seconds[0])


def test_a_speed_is_that_of_runs_that_agree_and_not_of_a_slow_start(monkeypatch):
    """The first runs get fresh memory, and two slow ones may agree by chance."""
    durations = iter([2.0, 2.01, 1.9, 1.0, 1.3, 1.005, 1.01, 0.1])
    clock = [0.0]

    def run() -> None:
        clock[0] += next(durations)

    monkeypatch.setattr(host_speed.time, "process_time", lambda: clock[0])
    assert quickest(run) == pytest.approx(1.0)
    assert next(durations) == 0.1, "no run after three that agree"


def test_runs_that_never_agree_end(monkeypatch):
    clock, number = [0.0], iter(range(1, 100))

    def run() -> None:
        clock[0] += 1.5 ** next(number)

    monkeypatch.setattr(host_speed.time, "process_time", lambda: clock[0])
    assert quickest(run) == pytest.approx(1.5) and 5 < next(number) < 20


@pytest.mark.parametrize("number", ["", "0", "several"])
def test_without_a_number_of_threads_there_are_as_many_as_cores(monkeypatch, number):
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", number)
    assert algebra_threads() == os.cpu_count()


@pytest.mark.parametrize(
    "damage",
    [
        "",
        "{",
        "[1]",
        '{"slowness": 2.0}',
        '{"identity": {"version": -1}, "slowness": 2.0}',
        '{"identity": null, "slowness": NaN}',
    ],
)
def test_a_damaged_or_foreign_measurement_is_made_anew(tmp_path, monkeypatch, damage):
    (tmp_path / FILE).write_text(damage, encoding="utf-8")
    monkeypatch.setattr(host_speed, "measured_slowness", lambda: 3.0)
    assert host_slowness(tmp_path) == 3.0
    assert json.loads((tmp_path / FILE).read_text(encoding="utf-8"))["slowness"] == 3.0


@pytest.mark.parametrize("value", [math.nan, 0.0, -1.0, 1e9])
def test_a_measurement_that_cannot_be_is_made_anew(tmp_path, monkeypatch, value):
    monkeypatch.setattr(host_speed, "measured_slowness", lambda: 3.0)
    host_slowness(tmp_path)
    content = json.loads((tmp_path / FILE).read_text(encoding="utf-8"))
    (tmp_path / FILE).write_text(json.dumps(content | {"slowness": value}), encoding="utf-8")
    assert host_slowness(tmp_path) == 3.0


def test_the_correction_converges_to_what_runs_agree_on(tmp_path):
    """Runs of 2.5 times the predicted time with 10 % of scatter: within the scatter from the third run on."""
    random = np.random.default_rng(5)
    found = []
    for _ in range(12):
        record(tmp_path, {"stage": 1.0}, {"stage": 2.5 * math.exp(0.1 * random.standard_normal())})
        found.append(corrections(tmp_path)["stage"])
    assert found[0] == 1.0
    assert max(abs(value / 2.5 - 1.0) for value in found[2:]) < 0.3
    assert found[-1] == pytest.approx(2.5, rel=0.1)


def test_one_odd_run_moves_nothing_far(tmp_path):
    for ratio in (2.0, 2.0, 2.0, 2.0, 2.0, 100.0):
        record(tmp_path, {"stage": 1.0}, {"stage": ratio})
    assert corrections(tmp_path) == {"stage": pytest.approx(2.0)}


def test_the_last_runs_decide(tmp_path):
    """A host that becomes faster is believed after as many runs as count."""
    for ratio in [4.0] * 60 + [1.5] * 40:
        record(tmp_path, {"stage": 1.0}, {"stage": ratio})
    assert corrections(tmp_path)["stage"] == pytest.approx(1.5)


def test_a_long_log_keeps_the_runs_that_count(tmp_path):
    """Every run reads the log: it stays short, and its corrections are those of the last runs."""
    random, last = np.random.default_rng(3), {"often": [], "rare": []}
    for number in range(1500):
        stage = "rare" if number % 300 == 0 else "often"
        ratio = math.exp(0.2 * random.standard_normal())
        last[stage] = [*last[stage], ratio][-LAST:]
        record(tmp_path, {stage: 1.0}, {stage: ratio})
    lines = (tmp_path / LOG).read_text(encoding="utf-8").splitlines()
    assert len(lines) < 800
    for stage, ratios in last.items():
        assert corrections(tmp_path)[stage] == pytest.approx(float(np.median([*ratios, 1.0, 1.0])), rel=5e-3)


def test_damaged_lines_and_missing_stages_are_passed_over(tmp_path):
    for _ in range(5):
        record(tmp_path, {"a": 1.0, "b": 0.0, "c": 1.0}, {"a": 3.0, "b": 1.0, "d": 1.0})
    with (tmp_path / LOG).open("a", encoding="utf-8") as stream:
        stream.write('{"stage": "a"\nnonsense\n{"stage": "a", "predicted": 0, "measured": 1}\n')
    assert corrections(tmp_path) == {"a": pytest.approx(3.0)}
    assert corrections(None) == {}
