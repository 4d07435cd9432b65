"""The figures that runs are compared by: mean, peak-to-peak, mesh orders of errors and bearing forces."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.influence.linear_figures import COMPARED
from dynamics.orders import order_track
from dynamics.results import RunResult
from dynamics.types import FloatArray
from model_studies import Figures, in_unit

HIGHEST = COMPARED
"""Mesh orders that are compared."""
PITCHES = 16
SETTLED = 0.5
"""Part of the run after which start-up transients are taken to have died out."""


@dataclass(frozen=True)
class RunFigures(Figures):
    """Figures of the settled part of a run.

    Attributes
    ----------
    mean, peak_to_peak : (m,) arrays
        Of the dynamic transmission error of every mesh, m.
    cpu_seconds : float
        Of the run.
    orders : (m, 5) array
        Largest amplitude along the run of the mesh orders 1 to 5 of the transmission error, m.
    bearing_orders : (b, 5) array
        Of the bearing forces, root of the sum of squares of their components, N; b = 0 if not stored.
    """

    orders: FloatArray = field(metadata=in_unit("m", "curve", "order"))
    bearing_orders: FloatArray = field(metadata=in_unit("n", "bearing", "order"))


def run_figures(result: RunResult, seconds: float) -> RunFigures:
    """Return the figures of a run of so many CPU seconds.

    Raises
    ------
    InputError
        It is shorter than a few base pitches.
    """
    settled = slice(int(SETTLED * result.time.size), None)
    error = result.dynamic_transmission_error[:, settled]
    pitches = max(1, min(PITCHES, int(_travel(result) / 4.0)))
    transmission = _largest(result, "dynamic_transmission_error", pitches)
    bearings = np.empty((0, HIGHEST))
    if result.bearing_force.size:
        bearings = np.sqrt(np.sum(_largest(result, "bearing_force", pitches) ** 2, axis=1))
    return RunFigures(
        np.mean(error, axis=1),
        np.ptp(error, axis=1),
        seconds,
        transmission,
        bearings,
    )


def _travel(result: RunResult) -> float:
    """Return the base pitches that the first mesh runs through."""
    return float(np.abs(np.sum(np.diff(np.unwrap(result.position[0], period=1.0)))))


def _largest(result: RunResult, series: str, pitches: int) -> FloatArray:
    """Largest amplitudes (..., 5) of the orders 1 to 5 over the settled blocks."""
    amplitude = order_track(result, series, pitches, HIGHEST).amplitude
    first = int(SETTLED * amplitude.shape[-2])
    return np.asarray(np.max(amplitude[..., first:, 1:], axis=-2))
