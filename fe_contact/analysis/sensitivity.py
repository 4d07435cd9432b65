"""Sensitivity of the transmission error's ripple to misalignment and center distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.analyze import analyze
from fe_contact.effects.corner_contact import CornerContact
from fe_contact.geometry import ParallelAxes
from fe_contact.progress import Progress
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess, Workers


@dataclass(frozen=True)
class RippleCurve:
    """Peak-to-peak transmission error over one deviation.

    Attributes
    ----------
    deviation : ndarray, shape (N,)
        Misalignment or change of the center distance in m, increasing; 0 is among them.
    peak_to_peak, error : ndarray, shape (N,)
        Peak-to-peak STE and the half-width of its error band, m.
    """

    deviation: FloatArray
    peak_to_peak: FloatArray
    error: FloatArray

    @property
    def relative_change(self) -> FloatArray:
        """Change over the value without deviation (N,): 1 is twice as large."""
        nominal = float(self.peak_to_peak[self.deviation == 0.0][0])
        return self.peak_to_peak / nominal - 1.0


@dataclass(frozen=True)
class Sensitivity:
    """Both curves of one pair at one load, with or without corner contact."""

    corner_contact: bool
    misalignment: RippleCurve
    center_distance_change: RippleCurve


def study_sensitivity(
    pair: ParallelAxes,
    *,
    normal_force: float,
    misalignments: Sequence[float] | FloatArray,
    center_distance_changes: Sequence[float] | FloatArray,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    effects: Mapping[str, str] | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    progress: Progress | None = None,
    cache: Path | None = None,
) -> tuple[Sensitivity, Sensitivity]:
    """Vary misalignment and center distance, one at a time, without and with corner contact.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    normal_force : float
        F_bn in N.
    misalignments, center_distance_changes : sequence of float
        Deviations in m; zero is added to both.
    tolerance, level, time_budget, model, positions, effects, progress, cache
        See `analyze`. An automatic model is three-dimensional at every point, so that the curves compare;
        the effects decide about everything but corner contact. Progress begins anew for each of the
        four tables. With `cache` the gears are condensed once.
    workers : Workers
        Who condenses the gears and solves the contact of every table.

    Returns
    -------
    tuple of Sensitivity
        Without and with corner contact.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    MeshError, SolveError
        No acceptable mesh, or points without a solution.
    """
    axes: dict[str, Any] = {
        "misalignments": np.union1d([0.0], misalignments),
        "center_distance_changes": np.union1d([0.0], center_distance_changes),
    }
    tables = [
        analyze(
            pair,
            normal_forces=[normal_force],
            tolerance=tolerance,
            level=level,
            time_budget=time_budget,
            model="3d" if model == "auto" else model,
            positions=positions,
            effects={**(effects or {}), CornerContact.name: corners},
            progress=progress,
            cache=cache,
            workers=workers,
            **{name: axis},
        )
        for corners in ("off", "on")
        for name, axis in axes.items()
    ]
    curves = [_ripple(table, name) for table, name in zip(tables, [*axes, *axes], strict=True)]
    return Sensitivity(False, curves[0], curves[1]), Sensitivity(True, curves[2], curves[3])


def _ripple(table: SteDatabase, axis: str) -> RippleCurve:
    """Peak-to-peak along the axis of a table of one load."""
    name = axis.removesuffix("s")
    deviation: FloatArray = getattr(table, name)
    found = [table.peak_to_peak(force=float(table.force[0]), **{name: float(x)}) for x in deviation]
    return RippleCurve(deviation, np.array([e.value for e in found]), np.array([e.error for e in found]))
