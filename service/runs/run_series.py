"""The series behind the figures of a run: one mesh with its driving gear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.results import RunResult
from service.drawing.figure import FloatArray, number


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
        Hz.
    position : (n,) array
        Travel of the driving gear in base pitches, not wrapped.
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
    """Take the series of one mesh out of a run."""
    shaft = run.shaft.index(driving_shaft(run, mesh))
    return RunSeries(
        time=run.time,
        speed_rpm=np.abs(run.speed[shaft]) * 30.0 / np.pi,
        mesh_frequency=run.mesh_frequency[mesh],
        position=np.abs(np.unwrap(run.position[mesh], period=1.0)),
        dynamic_error=run.dynamic_transmission_error[mesh],
        static_error=run.static_transmission_error[mesh],
        mesh_force=run.mesh_force[mesh],
        least_force=run.least_mesh_force[mesh],
        largest_force=run.largest_mesh_force[mesh],
        nominal_force=float(run.nominal_force[mesh]),
    )


def validity(valid_order: int, top: float) -> str:
    """Say up to which mesh order a picture holds at the highest mesh frequency `top`, Hz."""
    return f"Valid to mesh order {valid_order} at the highest mesh frequency, {number(top, 4)} Hz."


def driving_shaft(run: RunResult, mesh: int) -> str:
    """Name of the shaft that carries the driving gear."""
    driver = run.case["meshes"][mesh]["driver"]
    return str(next(gear["shaft"] for gear in run.case["gears"] if gear["name"] == driver))
