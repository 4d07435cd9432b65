"""The signal whose orders are shown: force on the bearing where it varies most, else the mesh force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.results import RunResult
from service.drawing.figure import Axis, FloatArray
from service.runs.run_series import driving_shaft

MONOTONE = 0.2  # least change of speed over the run, of the highest, for a speed axis


@dataclass(frozen=True)
class Signal:
    """A series of a run, and the row of its first axis."""

    series: str
    row: int
    name: str

    def of(self, amplitude: FloatArray) -> FloatArray:
        """Take the row; amplitudes of three components are added in power."""
        taken = amplitude[self.row]
        return taken if self.series == "mesh_force" else np.asarray(np.sqrt(np.sum(taken**2, axis=0)))


def shown_signal(run: RunResult) -> Signal:
    """Choose the signal."""
    if not run.bearing:
        return Signal("mesh_force", 0, f"mesh force of {run.mesh[0]}")
    loudest = int(np.argmax(np.var(run.bearing_force, axis=-1).sum(axis=-1)))
    return Signal("bearing_force", loudest, f"force on bearing {run.bearing[loudest]}")


def run_axis(run: RunResult, time: FloatArray) -> tuple[Axis, FloatArray]:
    """Return the axis for blocks at `time`: speed where it rises or falls all along, else time."""
    shaft = run.shaft.index(driving_shaft(run, 0))
    speed = np.interp(time, run.time, np.abs(run.speed[shaft])) * 30.0 / np.pi
    steps = np.diff(speed)
    swept = bool(np.all(steps > 0.0) or np.all(steps < 0.0))
    if swept and np.ptp(speed) > MONOTONE * speed.max():
        return Axis("speed of the driving gear, rpm"), speed
    return Axis("time, s"), time
