"""Predicted and measured cost: speed of the host, log of earlier work, growth of memory, announcement."""

import json
import subprocess
import sys

import numpy as np
import pytest

from dynamics.work_cost import Cost, WorkMeter, announce, on_this_host
from host import memory_figure
from model_studies import host_speed
from model_studies.run_log import FILE, record

GROWN = """
import json
import numpy as np
from dynamics.work_cost import Cost, WorkMeter, peak_memory
size = 2 * peak_memory()
grown = []
for part in (8, 16):
    meter = WorkMeter.at_start("work", Cost(0.0, 0.0), None)
    np.ones(size // part).sum()
    grown.append(meter.finish().bytes)
print(json.dumps([size, *grown]))
"""
KIND, COST = "work", Cost(10.0, 2e9)


@pytest.fixture(autouse=True)
def _host_three_times_as_slow(monkeypatch):
    monkeypatch.setattr(host_speed, "measured_slowness", lambda: 3.0)


def test_a_slow_host_takes_longer_and_no_more_memory(tmp_path):
    for cache in (None, tmp_path):
        assert on_this_host(KIND, COST, cache) == (30.0, 2e9)


def test_earlier_work_of_a_kind_corrects_its_prediction_alone(tmp_path):
    for _ in range(5):
        record(tmp_path, {KIND: 30.0}, {KIND: 60.0})
    assert on_this_host(KIND, COST, tmp_path).seconds == pytest.approx(60.0)
    assert on_this_host("other work", COST, tmp_path).seconds == 30.0


def test_work_is_logged_beside_its_uncorrected_prediction(tmp_path):
    """Else a correction would be corrected again, and forgotten after so many runs."""
    for _ in range(5):
        record(tmp_path, {KIND: 30.0}, {KIND: 60.0})
    meter = WorkMeter.at_start(KIND, COST, tmp_path)
    np.sin(np.arange(3_000_000.0))
    cost = meter.finish()
    last = json.loads((tmp_path / FILE).read_text("utf-8").splitlines()[-1])
    assert (last["stage"], last["predicted"]) == (KIND, 30.0)
    assert last["measured"] == cost.seconds > 0.0
    assert (cost.predicted_seconds, cost.predicted_bytes) == (pytest.approx(60.0), COST.bytes)


@pytest.mark.skipif(memory_figure("VmRSS") is None, reason="the system does not tell resident memory")
def test_memory_is_what_the_process_grew_by_or_not_known():
    """In a process of its own, which is small."""
    done = subprocess.run([sys.executable, "-c", GROWN], capture_output=True, text=True, check=True)
    size, first, second = json.loads(done.stdout)
    assert first == pytest.approx(size, rel=0.05)
    assert second is None


def test_one_after_the_other_seconds_add_up_and_memory_is_used_again():
    assert COST.then(Cost(5.0, 3e9)) == (15.0, 3e9)
    assert COST.times(4) == (40.0, 2e9)


def test_what_takes_a_moment_is_not_announced():
    told: list[tuple[str, float]] = []
    announce(lambda *step: told.append(step), "housing", "case", Cost(2.9, 1e9))
    assert not told
    announce(lambda *step: told.append(step), "housing", "case", Cost(24.6, 1.16e9))
    assert told == [("housing; case: about 25 CPU s, 1.2 GB", 0.0)]
