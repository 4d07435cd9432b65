"""Sensitivity of the transmission error's ripple to misalignment and center distance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.analyze import ste_database
from fe_contact.effects import EFFECTS, named
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray


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
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
) -> tuple[Sensitivity, Sensitivity]:
    """Vary misalignment and center distance, one at a time, without and with corner contact.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    axes : TableAxes
        One load, and the deviations; zero is added to both.
    options : AnalysisOptions
        An automatic model is three-dimensional at every point, so the curves are comparable; `effects` apply
        to all effects but corner contact.
    run : Run
        Progress starts again for each of the four tables. With a cache the gears are condensed once.

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
    options = replace(options, model="3d" if options.model == "auto" else options.model)
    effect = named(EFFECTS, "corner_contact")
    without, with_corners = (
        replace(options, effects={**options.effects, effect: choice}) for choice in ("off", "on")
    )
    return (
        Sensitivity(False, *_curves(pair, axes, without, run)),
        Sensitivity(True, *_curves(pair, axes, with_corners, run)),
    )


def _curves(
    pair: ParallelAxes, axes: TableAxes, options: AnalysisOptions, run: Run
) -> tuple[RippleCurve, RippleCurve]:
    nominal = replace(axes, misalignments=(0.0,), center_distance_changes=(0.0,))
    skews = replace(nominal, misalignments=np.union1d([0.0], axes.misalignments))
    changes = replace(nominal, center_distance_changes=np.union1d([0.0], axes.center_distance_changes))
    skewed, moved = (ste_database(pair, each, options, run) for each in (skews, changes))
    return _ripple(skewed, "misalignment"), _ripple(moved, "center_distance_change")


def _ripple(table: SteDatabase, axis: str) -> RippleCurve:
    deviation: FloatArray = getattr(table, axis)
    ripples = [table.peak_to_peak(force=float(table.force[0]), **{axis: float(x)}) for x in deviation]
    return RippleCurve(deviation, np.array([e.value for e in ripples]), np.array([e.error for e in ripples]))
