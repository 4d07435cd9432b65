"""Phase after ten million integrated steps: a drive at constant speed, a train that torques accelerate."""

from __future__ import annotations

from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

STEPS = 10_000_000
_TESTS = Path(__file__).parents[1] / "tests"
_FOLDERS = [str(_TESTS / "fakes"), str(_TESTS / "verification" / "dynamics")]
_RUN = """
import sys, time
sys.path[:0] = {folders!r}
from test_run_ups import accelerating, imposed, phase_error
measured = {{}}
for make in (imposed, accelerating):
    phase_error(make(1000))  # compiles where nothing is cached yet
    began = time.process_time()
    measured[make.__name__] = abs(phase_error(make({steps})))
    measured[make.__name__ + "_seconds"] = time.process_time() - began
"""


def figures() -> list[Figure]:
    """Return the errors and what the runs took."""
    found = measure(_RUN.format(folders=_FOLDERS, steps=STEPS))
    subject = "phase after 1e7 integrated steps"
    return [
        figure
        for name, what in (("imposed", "imposed speed"), ("accelerating", "free train, accelerated"))
        for figure in (
            Figure(subject, what, found[name], "base pitches", 1e-9),
            Figure(subject, f"{what}: time", found[f"{name}_seconds"], "CPU s"),
        )
    ]
