"""Sensitivity of the transmission error's ripple to misalignment and center distance."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from bounds.brief import brief
from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked, checked_request
from fe_contact.effects import EFFECTS, named
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from model_studies import in_unit


@dataclass(frozen=True)
class RippleCurve:
    """Peak-to-peak transmission error over one deviation."""

    deviation: FloatArray = field(metadata=in_unit("m", "deviation"))
    """Misalignment or change of the center distance in m, increasing; 0 is among them. Shape (N,)."""
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "deviation"))
    error: FloatArray = field(metadata=in_unit("m", "deviation"))
    """`peak_to_peak`, `error`: Peak-to-peak STE and the half-width of its error band, m. Shape (N,) each."""
    carrying: FloatArray = field(metadata=in_unit("1", "deviation"))
    """Mean number of pairs that carry over the positions: the contact ratio under load. It is known to one
    position in all. Shape (N,).
    """

    @property
    def relative_change(self) -> FloatArray:
        """Change over the value without deviation (N,): 1 is twice as large."""
        nominal = float(self.peak_to_peak[self.deviation == 0.0][0])
        return self.peak_to_peak / nominal - 1.0


@brief
@dataclass(frozen=True)
class Sensitivity:
    """Both curves of one pair at one load, with or without corner contact."""

    corner_contact: bool
    misalignment: RippleCurve
    center_distance_change: RippleCurve

    @staticmethod
    def request(pair: ParallelAxes | Checked, axes: TableAxes | None, options: AnalysisOptions) -> Checked:
        """Check the request over both deviations, once: each table decides what it neglects."""
        model = "3d" if options.model == "auto" else options.model
        return as_checked(pair, axes, replace(options, model=model), neglect=False)


def study_sensitivity(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
) -> tuple[Sensitivity, Sensitivity]:
    """Vary misalignment and center distance, one at a time, without and with corner contact.

    Raises `InputError`: a value that cannot be used, by field name; `MeshError`, `SolveError`: no acceptable
    mesh, or points without a solution.

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        What `Sensitivity.request` returns stands for pair, axes and options.
    axes : TableAxes, optional
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
    """
    checked = Sensitivity.request(pair, axes, options)
    return Sensitivity(False, *_curves(checked, "off", run)), Sensitivity(True, *_curves(checked, "on", run))


def _curves(checked: Checked, corner_contact: str, run: Run) -> tuple[RippleCurve, RippleCurve]:
    """Return both curves; every table neglects what it does not need itself."""
    base, none = checked.request, np.zeros(1)
    effects = {**base.options.effects, named(EFFECTS, "corner_contact"): corner_contact}
    request = replace(base, options=replace(base.options, effects=effects), nodes_alone=True)
    skews, changes = (np.union1d(none, axis) for axis in (base.misalignment, base.center_distance_change))
    skewed, shifted = (
        analyze(checked_request(replace(request, misalignment=skew, center_distance_change=change)), run=run)
        for skew, change in ((skews, none), (none, changes))
    )
    return _ripple(skewed, "misalignment"), _ripple(shifted, "center_distance_change")


def _ripple(table: SteDatabase, axis: str) -> RippleCurve:
    deviation: FloatArray = getattr(table, axis)
    ripples = [table.peak_to_peak(force=float(table.force[0]), **{axis: float(x)}) for x in deviation]
    values, errors = (np.array([getattr(ripple, name) for ripple in ripples]) for name in ("value", "error"))
    return RippleCurve(deviation, values, errors, _carrying(table))


def _carrying(table: SteDatabase) -> FloatArray:
    """Return the mean number of pairs that carry at each deviation of a table over one of them, (N,)."""
    share = table.load_share[:, 0]  # (P, M, D, pairs) at the one load
    pairs = np.sum(share > 0.0, axis=-1).reshape(share.shape[0], -1)
    ahead = np.append(table.position[1:], table.position[0] + table.period) - table.position
    reach = 0.5 * (ahead + np.roll(ahead, 1))  # of the position, half of the way to either side
    return np.asarray(reach @ pairs / table.period)
