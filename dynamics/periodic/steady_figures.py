"""Figures of periodic motions: size of the transmission error, forces, contact, stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.periodic.floquet import ComplexArray, Instability
from dynamics.periodic.motion import motion
from dynamics.periodic.period_map import PeriodicProblem
from dynamics.periodic.shooting import Orbit
from dynamics.types import FloatArray, IntArray

FINE = 256  # samples per base pitch, for the share of the period that flanks touch
PER_MESH = (
    "mean_error",
    "rms_error",
    "peak_to_peak_error",
    "least_force",
    "largest_force",
    "parted",
    "coasting",
)
KINDS = (Instability.NONE, Instability.FOLD, Instability.PERIOD_DOUBLING, Instability.NEIMARK_SACKER)


@dataclass(frozen=True)
class MotionFigures:
    """Figures of P motions as `SteadyStates` holds them."""

    speed: FloatArray
    status: IntArray
    residual: FloatArray
    iterations: IntArray
    step_error: FloatArray
    instability: IntArray
    multiplier: ComplexArray
    mean_error: FloatArray
    rms_error: FloatArray
    peak_to_peak_error: FloatArray
    least_force: FloatArray
    largest_force: FloatArray
    parted: FloatArray
    coasting: FloatArray
    rms_bearing_force: FloatArray


def figures_of(problem: PeriodicProblem, orbits: Sequence[Orbit]) -> MotionFigures:
    """Return the figures of all `orbits`; NaN where no motion was found."""
    meshes, bearings = len(problem.system.scene.meshes), len(problem.system.supports.name)
    per_mesh = np.full((len(PER_MESH), len(orbits), meshes), np.nan)
    on_bearing = np.full((len(orbits), bearings), np.nan)
    for index, orbit in enumerate(orbits):
        if orbit.status.usable:
            per_mesh[:, index], on_bearing[index] = _figures(problem, orbit)
    return MotionFigures(
        np.array([abs(orbit.speed) for orbit in orbits]),
        np.array([int(orbit.status) for orbit in orbits], dtype=np.int64),
        np.array([orbit.residual for orbit in orbits]),
        np.array([orbit.iterations for orbit in orbits], dtype=np.int64),
        np.array([orbit.step_error for orbit in orbits]),
        np.array([KINDS.index(orbit.instability) for orbit in orbits], dtype=np.int64),
        np.array([orbit.multipliers for orbit in orbits]),
        **dict(zip(PER_MESH, per_mesh, strict=True)),
        rms_bearing_force=on_bearing,
    )


def _figures(problem: PeriodicProblem, orbit: Orbit) -> tuple[FloatArray, FloatArray]:
    """Return the seven figures of every mesh (7, m), and the alternating force on every bearing (b,)."""
    series = motion(problem, orbit, FINE)
    error, force = series.dynamic_transmission_error, series.mesh_force
    coasting = np.zeros(force.shape[0])
    for row, mesh in enumerate(problem.system.flanks.coast):
        coasting[mesh] = np.mean(series.coast_force[row] > 0.0)
    figures = (
        np.mean(error, axis=1),
        np.std(error, axis=1),
        np.ptp(error, axis=1),
        np.min(force, axis=1),
        np.max(force, axis=1),
        series.parted,
        coasting,
    )
    bearing = np.sqrt(np.sum(np.var(series.bearing_force[:, :3], axis=-1), axis=1))
    return np.array(figures), np.asarray(bearing)
