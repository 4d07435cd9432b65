"""``loa simulate``: Ctrl-C keeps what was computed, ``--resume`` goes on from there."""

import signal

import numpy as np
import pytest
from command_line import loa
from geared_scenes import gear_pair_scene

from dynamics import RunResult, simulate
from dynamics.types import RunStatus
from lineofaction.cli.simulate import _run, _run_headlines
from lineofaction.gearbox.convert.scene_effects import scene_table
from lineofaction.gearbox.interrupts import until_interrupted
from lineofaction.gearbox.units import boundary_ledger

SCENE = gear_pair_scene(duration=0.02)


def test_ctrl_c_keeps_what_was_computed_and_resume_goes_on(tmp_path):
    path = tmp_path / "run.nc"

    def stop(_stage, fraction):
        if 0.3 < fraction < 0.33:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt, match="--resume continues"):
        _run(SCENE, path, stop, resume=False)
    part = RunResult.from_netcdf(path)
    assert part.status is RunStatus.CANCELLED
    assert 0.3 * 0.02 < part.time[-1] < 0.4 * 0.02
    _run(SCENE, path, lambda *_: None, resume=True)
    np.testing.assert_array_equal(RunResult.from_netcdf(path).mesh_force, simulate(SCENE).mesh_force)


def test_a_second_interrupt_is_not_held_back():
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt), until_interrupted() as cancelled:
        signal.raise_signal(signal.SIGINT)
        assert cancelled()
        signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before


def test_a_run_says_which_effects_are_on_and_what_the_others_change():
    entries = [
        {
            "effect": "flexible_shafts",
            "part": "input",
            "on": False,
            "influence_m": 2e-6,
            "reason": "switched off",
        },
        {"effect": "tilt", "part": "input", "on": False, "influence_m": 0.0, "reason": "centered"},
        {"effect": "lateral", "part": "input", "on": True, "influence_m": 1.33e-5, "reason": "pushed aside"},
    ]
    entries.append(entries[-1] | {"part": "output", "influence_m": 2e-6})
    entries.append(entries[-1] | {"part": "idler", "reason": "left alone"})
    names = ("relative_mean", "relative_peak_to_peak", "relative_bearing_force")
    small = dict.fromkeys(names, 2e-4) | {"words": "0.02 % of all", "freedoms": 4}
    large = small | {"words": "17 % of all", "relative_mean": -0.17}
    ledger = {"entries": entries, "influences": {"tilt": small, "lateral": large}}
    columns, rows, trifles = scene_table(boundary_ledger(ledger))
    assert columns == ["effect", "on", "without it", "freedoms", "where and why"]
    assert rows == [
        ["flexible shafts", "no", "2 µm along the line of action at rest", "", "input: switched off"],
        ["lateral", "yes", "17 % of all", "+4", "input, output: pushed aside\nidler: left alone"],
    ]
    assert trifles == "1 effect below 0.1 %: tilt"


def test_a_run_ends_with_its_largest_forces():
    peaks = {
        "mesh_force": {"a": {"peak": 3.0, "rms": 1.0}, "b": {"peak": 5.0, "rms": 2.0}},
        "bearing_force": {"left": {"peak": [3.0, 4.0, 0.0], "rms": [0.6, 0.8, 0.0]}},
    }
    lines = [(line.name, line.value, line.remark) for line in _run_headlines(peaks)]
    assert lines == [
        ("largest mesh force of b", "5.000 N", "rms 2.000 N"),
        ("largest force on bearing left, y", "4.000 N", "rms 0.8000 N"),
    ]
    assert _run_headlines({}) == ()


def test_resume_without_an_interrupted_run_is_refused(tmp_path):
    scene = "examples/palermo_scene.toml"
    ended = loa("simulate", scene, "-o", tmp_path / "run.nc", "--resume")
    assert ended.exit_code == 2
