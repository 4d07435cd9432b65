"""The series behind the figures of a run: one mesh with its driving gear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.orders import order_frequency
from dynamics.results import RunResult
from lineofaction.gearbox.studies.listen.sound_figures import driving_shaft
from lineofaction.report.drawing.figure import FloatArray, number


@dataclass(frozen=True)
class RunSeries:
    """Time series of a run, all on one uniform grid of n samples.

    Attributes
    ----------
    time : (n,) array
        s.
    speed_rpm : (n,) array
        Speed of the driving gear, without sign.
    mesh_frequency : (n,) array
        By which orders count, Hz.
    position : (n,) array
        Travel of the driving gear in base pitches, without gears of the shaft in turns, not wrapped.
    dynamic_error, static_error : (n,) arrays
        Transmission errors in m; the static one is the table's at the nominal force.
    mesh_force, least_force, largest_force : (n,) arrays
        Transverse, N; the extremes around each sample are those of the unfiltered force.
    nominal_force : float
        Transverse mesh force in N that the load asks for.
    """

    time: FloatArray
    speed_rpm: FloatArray
    mesh_frequency: FloatArray
    position: FloatArray
    dynamic_error: FloatArray
    static_error: FloatArray
    mesh_force: FloatArray
    least_force: FloatArray
    largest_force: FloatArray
    nominal_force: float


def run_series(run: RunResult, mesh: int = 0) -> RunSeries:
    """Take the series of one mesh out of a run; of one without meshes those of its leading shaft alone."""
    shaft = run.shaft.index(driving_shaft(run, mesh))
    speed, frequency = np.abs(run.speed[shaft]) * 30.0 / np.pi, order_frequency(run, mesh)
    if not run.mesh:
        turns = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(run.time) * (frequency[1:] + frequency[:-1]))])
        none = np.zeros(run.time.size)
        return RunSeries(run.time, speed, frequency, turns, none, none, none, none, none, 0.0)
    return RunSeries(
        time=run.time,
        speed_rpm=speed,
        mesh_frequency=frequency,
        position=np.abs(np.unwrap(run.position[mesh], period=1.0)),
        dynamic_error=run.dynamic_transmission_error[mesh],
        static_error=run.static_transmission_error[mesh],
        mesh_force=run.mesh_force[mesh],
        least_force=run.least_mesh_force[mesh],
        largest_force=run.largest_mesh_force[mesh],
        nominal_force=float(run.nominal_force[mesh]),
    )


def validity(valid_order: int, top: float, of: str = "mesh") -> str:
    """Say up to which order of a `mesh` or `shaft` a picture holds at its highest frequency `top`, Hz."""
    return f"Valid to {of} order {valid_order} at the highest {of} frequency, {number(top, 4)} Hz."


def counted_by(run: RunResult) -> str:
    """Say what orders of a run are multiples of: "mesh", or "shaft" where it has none."""
    return "mesh" if run.mesh else "shaft"
