"""A run through the whole command line: Ctrl-C in the middle and --resume, against one that never stopped."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import pytest
from command_line import loa
from running_service import PATIENCE_S
from scene_files import scene_file

DURATION, RATE = 5.0, 10_000.0
RECORD = 8 * (2 * 5 + 1 + 2 * 5 + 3 + 2)  # q, v, quanta; filtered with force, place, error; extremes
EDGE = 12  # samples


HELD = """
import sys, time
from pathlib import Path
from lineofaction.cli import commands
from lineofaction.cli import simulate
march, enough = simulate.simulate_to_file, int(sys.argv.pop(1))
states, gate = Path(sys.argv.pop(1)), Path(sys.argv.pop(1))
def held(*arguments, progress, **more):
    def report(*told):
        progress(*told)
        while states.is_file() and states.stat().st_size >= enough and not gate.exists():
            time.sleep(0.01)
    return march(*arguments, progress=report, **more)
simulate.simulate_to_file = held
commands.main()
"""


def command(folder: Path, *arguments: str) -> list[str]:
    return [sys.executable, "-m", "lineofaction.cli", "simulate", str(folder / "scene.toml"), *arguments]


def environment(folder: Path) -> dict[str, str]:
    root = str(Path(__file__).parents[2])
    path = os.pathsep.join(part for part in (root, os.environ.get("PYTHONPATH", "")) if part)
    return os.environ | {"OMP_NUM_THREADS": "1", "XDG_CACHE_HOME": str(folder / "cache"), "PYTHONPATH": path}


def content(path: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Variables and attributes of a run; the receipt holds times."""
    with h5netcdf.File(path, "r") as file:
        variables = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
        return variables, {name: str(value) for name, value in file.attrs.items() if name != "receipt"}


def interrupted_in_the_middle(folder: Path, path: Path) -> subprocess.CompletedProcess[str]:
    """Start a run and interrupt it once a fifth of its samples are on disk: it waits there for that."""
    states, gate = path.with_name(f"{path.name}.partial") / "run.states", folder / "interrupted"
    enough = int(0.2 * DURATION * RATE * RECORD)
    held = [sys.executable, "-c", HELD, str(enough), str(states), str(gate)]
    started = subprocess.Popen(
        [*held, *command(folder, "-o", str(path), "--json")[3:]],
        env=environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        while not states.is_file() or states.stat().st_size < enough:
            assert started.poll() is None, started.communicate()
            time.sleep(0.01)
        started.send_signal(signal.SIGINT)
        gate.touch()
        out, err = started.communicate(timeout=PATIENCE_S)
        return subprocess.CompletedProcess(started.args, started.returncode, out, err)
    finally:
        started.kill()
        started.wait()


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(folder, *arguments), env=environment(folder), capture_output=True, text=True, check=False
    )


@pytest.mark.law
def test_ctrl_c_and_resume_give_the_file_of_a_run_that_never_stopped(tmp_path):
    scene_file(tmp_path, duration=DURATION, rate=RATE)
    whole, parts = tmp_path / "whole.nc", tmp_path / "parts.nc"
    stopped = interrupted_in_the_middle(tmp_path, parts)
    assert (stopped.returncode, stopped.stdout) == (130, "")
    assert "interrupted" in stopped.stderr and "--resume continues" in stopped.stderr
    first, attributes = content(parts)
    assert attributes["status"] == "CANCELLED"
    assert 0.2 * DURATION <= first["time"][-1] < DURATION

    resumed = run(tmp_path, "-o", str(parts), "--resume", "--json")
    assert (resumed.returncode, resumed.stderr) == (0, "")
    assert json.loads(resumed.stdout)["attributes"]["status"] == "COMPLETED"
    assert not (tmp_path / "parts.nc.partial").exists()
    never = loa("simulate", tmp_path / "scene.toml", "-o", whole)
    assert never.exit_code == 0, never.stderr

    (ours, said), (expected, told) = content(parts), content(whole)
    assert said == told
    assert ours.keys() == expected.keys() and ours["time"].size == DURATION * RATE + 1
    for name, values in expected.items():
        assert ours[name].dtype == values.dtype and np.array_equal(ours[name], values), name
        assert values.dtype == object or ours[name].tobytes() == values.tobytes(), name
    same = first["time"].size - EDGE  # the filter sees no further at the end of what was made
    for name in ("mesh_force", "bearing_force"):
        assert np.array_equal(first[name][..., :same], expected[name][..., :same]), name
