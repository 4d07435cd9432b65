"""Cost of time integration: 24 freedoms, over duration and number of meshes, of neglected effects."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

DURATIONS = (1.0, 2.0, 5.0, 10.0)
MESHES = (1, 2, 4, 8)
SUBJECT = "time integration of gear stages"
_TABLE = (
    PAIR
    + """
analyze(pair, torques={torques}, model="plane_strain").to_netcdf({table!r})
measured = {{}}
"""
)
_CASE = "from benchmarks import dynamics_cases\nmeasured = dynamics_cases.{call}\n"


def figures() -> list[Figure]:
    """Return times, exponents of their growth, and ratios of effects off to effects absent."""
    with tempfile.TemporaryDirectory() as folder:
        table = str(Path(folder) / "ste.nc")
        measure(_TABLE.format(torques=list(TORQUES), table=table))
        calls = (
            f"run_up({table!r})",
            f"by_duration({table!r}, {DURATIONS})",
            f"by_meshes({table!r}, {MESHES})",
            f"switched_off({table!r})",
        )
        run_up, duration, meshes, off = (measure(_CASE.format(call=call)) for call in calls)
    off.pop("process_cpu_seconds")
    subject = "5 s run-up, 24 freedoms, 2 meshes, all bearing and mesh forces stored"
    return [
        Figure(
            subject, "once compiled, minimal receipt, without energy audit", run_up["minimal"], "CPU s", 1.0
        ),
        Figure(subject, "with error estimates, without energy audit", run_up["alone"], "CPU s"),
        Figure(subject, "with error estimates and energy audit", run_up["audited"], "CPU s"),
        Figure(subject, "energy unaccounted for", 100.0 * run_up["energy"], "%", 0.1),
        Figure(
            SUBJECT, "1 to 10 s: exponent of CPU time", _exponent(DURATIONS, duration["seconds"]), "-", 1.05
        ),
        Figure(SUBJECT, "1 to 10 s: exponent of steps", _exponent(DURATIONS, duration["steps"]), "-", 1.01),
        Figure(
            SUBJECT, "1 to 8 meshes: exponent of CPU time", _exponent(MESHES, meshes["seconds"]), "-", 1.1
        ),
        Figure(SUBJECT, "1 to 8 meshes: exponent of steps", _exponent(MESHES, meshes["steps"]), "-"),
        Figure(SUBJECT, "1 to 8 meshes: exponent of time per step", _per_step(meshes), "-", 1.05),
        *(
            Figure("neglected effects", f"{name}: time over a scene without", _ratio(times), "%", 105.0)
            for name, times in off.items()
        ),
        *(
            Figure("neglected effects", f"{name}: results that differ", 1.0 - times["same"], "-", 0.0)
            for name, times in off.items()
        ),
    ]


def _exponent(size: tuple[float, ...] | tuple[int, ...], cost: list[float]) -> float:
    """Return the slope of cost over size in logarithms, by least squares."""
    return float(np.polyfit(np.log(size), np.log(cost), 1)[0])


def _per_step(meshes: dict[str, list[float]]) -> float:
    """Return the exponent of CPU time per step over the number of meshes."""
    return _exponent(MESHES, [t / n for t, n in zip(meshes["seconds"], meshes["steps"], strict=True)])


def _ratio(times: dict[str, float]) -> float:
    """Return the time with the effect off over that without it, %."""
    return 100.0 * times["off"] / times["absent"]
