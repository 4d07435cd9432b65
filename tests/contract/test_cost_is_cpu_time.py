"""Every cost of a receipt is CPU time, children included; elapsed time stands under `wall_seconds`."""

import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import structure
from geared_scenes import gear_pair_scene

from bounds.types import Json
from dynamics import Integration, RunResult, Scene, simulate, simulate_to_file
from dynamics.types import RunStatus
from model_studies.stage_clock import StageClock

STALL_S, BURNT_S = 0.02, 0.4
SCENE = gear_pair_scene(duration=0.02)
FINER = replace(SCENE, integration=Integration(estimate_error=True))
Runs = Callable[[Scene, Path, Callable[..., None]], Json]


def _in_memory(scene: Scene, path: Path, progress: Callable[..., None]) -> Json:
    return simulate(scene, progress).receipt


def _to_file(scene: Scene, path: Path, progress: Callable[..., None]) -> Json:
    simulate_to_file(scene, path, progress=progress)
    return RunResult.from_netcdf(path).receipt


def _resumed(scene: Scene, path: Path, progress: Callable[..., None]) -> Json:
    """Cancelled as soon as something is done; what it took until then counts."""
    done = iter((False, True))
    assert simulate_to_file(scene, path, progress=progress, cancel=lambda: next(done)) is RunStatus.CANCELLED
    simulate_to_file(scene, path, resume=True)
    return RunResult.from_netcdf(path).receipt


class _Counted:
    """Progress that does something at its first calls, and says how often it did."""

    def __init__(self, does: Callable[[], object], maximum: int) -> None:
        self.does, self.maximum, self.calls = does, maximum, 0

    def __call__(self, *_: object) -> None:
        if self.calls < self.maximum:
            self.calls += 1
            self.does()


def _burn() -> None:
    """A child does nothing but work, and ends."""
    work = f"import time\nwhile time.process_time() < {BURNT_S}: pass"
    subprocess.run([sys.executable, "-S", "-c", work], check=True)


WAYS = pytest.mark.parametrize("run", [_in_memory, _to_file, _resumed])


@pytest.mark.law
@WAYS
def test_a_run_that_stalls_costs_no_more_and_lasts_longer(run, tmp_path):
    stalls = _Counted(lambda: time.sleep(STALL_S), 50)
    receipt = run(SCENE, tmp_path / "run.nc", stalls)
    cost, elapsed = receipt["seconds"], receipt["wall_seconds"]
    assert cost.keys() == elapsed.keys()
    stalled = STALL_S * (stalls.calls - 1)  # the last call says that the run is done
    assert elapsed["integration"] >= stalled > 0.0
    assert cost["integration"] <= elapsed["integration"] - 0.9 * stalled


@WAYS
def test_what_a_child_does_costs(run, tmp_path):
    receipt = run(SCENE, tmp_path / "run.nc", _Counted(_burn, 1))
    assert receipt["seconds"]["integration"] >= BURNT_S


@pytest.mark.parametrize("run", [_in_memory, _to_file])
def test_the_finer_run_that_measures_the_error_is_a_part_of_the_cost(run, tmp_path):
    stalls = _Counted(lambda: time.sleep(STALL_S), 1000)
    receipt = run(FINER, tmp_path / "run.nc", stalls)
    cost, elapsed = receipt["seconds"]["error_estimate"], receipt["wall_seconds"]["error_estimate"]
    assert 0.0 < receipt["error"]["time_step"]["seconds"] <= cost
    assert elapsed >= 0.45 * stalls.calls * STALL_S, "of two runs that report alike"
    assert cost <= elapsed - 0.4 * stalls.calls * STALL_S


def test_stages_of_a_table_count_alike():
    clock = StageClock()
    with clock.stage("stalled"):
        time.sleep(10 * STALL_S)
    with clock.stage("child"):
        _burn()
    stages = clock.to_json()["stages"]
    assert stages["stalled"]["cpu_seconds"] < STALL_S < 10 * STALL_S <= stages["stalled"]["wall_seconds"]
    assert stages["child"]["cpu_seconds"] >= BURNT_S


def test_libraries_read_no_other_clock():
    clocks = ("perf_counter", "process_time", "thread_time")
    houses = ("fe_contact", "dynamics", "lineofaction/gearbox", "lineofaction/report")
    files = [file for house in houses for file in structure.files_of(house)]
    assert files
    wrong = [str(file) for file in files if any(name in file.read_text("utf-8") for name in clocks)]
    assert not wrong, "use model_studies.stage_clock or host.cpu_seconds"
