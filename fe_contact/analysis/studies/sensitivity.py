"""Sensitivity of the transmission error's ripple to misalignment and center distance."""

from __future__ import annotations

from collections.abc import Iterator
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
    """Mean number of pairs that carry load over a period: the contact ratio under load.

    Its resolution is the spacing of the positions, at which contact is seen to begin and end. Shape (N,).
    """

    @property
    def relative_change(self) -> FloatArray:
        """Change over the value without deviation (N,): 1 is twice as large."""
        nominal = float(self.peak_to_peak[self.deviation == 0.0][0])
        return self.peak_to_peak / nominal - 1.0

    @property
    def change_error(self) -> FloatArray:
        """Error of the relative change (N,): both errors as independent ones; 0 without deviation."""
        undeviated = self.deviation == 0.0
        nominal, error = float(self.peak_to_peak[undeviated][0]), float(self.error[undeviated][0])
        both = np.hypot(self.error, error * (1.0 + self.relative_change)) / nominal
        return np.where(undeviated, 0.0, both)


@brief
@dataclass(frozen=True)
class Sensitivity:
    """Both curves of one pair at one load, with or without corner contact."""

    corner_contact: bool
    misalignment: RippleCurve
    center_distance_change: RippleCurve

    @staticmethod
    def request(pair: ParallelAxes | Checked, axes: TableAxes | None, options: AnalysisOptions) -> Checked:
        """Check the request over both deviations. The effects to neglect are chosen later, for each table."""
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
        Gear pair, or a checked request (see `Sensitivity.request`), which replaces pair, axes and options.
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
    return _sensitivity(checked, run, corner_contact=False), _sensitivity(checked, run, corner_contact=True)


def _sensitivity(checked: Checked, run: Run, *, corner_contact: bool) -> Sensitivity:
    """Compute a table over each deviation, the other deviation zero."""
    base, zero = checked.request, np.zeros(1)
    effects = {**base.options.effects, named(EFFECTS, "corner_contact"): "on" if corner_contact else "off"}
    # the curves are read at the requested deviations alone, so none is inserted between them for a tolerance
    request = replace(base, options=replace(base.options, effects=effects), nodes_alone=True)

    misalignments = np.union1d(zero, base.misalignment)
    changes = np.union1d(zero, base.center_distance_change)
    misaligned = replace(request, misalignment=misalignments, center_distance_change=zero)
    displaced = replace(request, misalignment=zero, center_distance_change=changes)
    skewed = _ripple(analyze(checked_request(misaligned), run=run), "misalignment")
    moved = _ripple(analyze(checked_request(displaced), run=run), "center_distance_change")
    return Sensitivity(corner_contact, *_with_one_nominal(skewed, moved))


def _with_one_nominal(*curves: RippleCurve) -> Iterator[RippleCurve]:
    """Yield the curves with the same error at deviation 0, which is the same pair in all: the least estimate.

    Estimates that a table makes for all its deviations together are larger than those of its nominal point.
    """
    least = min(float(curve.error[curve.deviation == 0.0][0]) for curve in curves)
    for curve in curves:
        yield replace(curve, error=np.where(curve.deviation == 0.0, least, curve.error))


def _ripple(table: SteDatabase, axis: str) -> RippleCurve:
    deviation: FloatArray = getattr(table, axis)
    ripples = [table.peak_to_peak(force=float(table.force[0]), **{axis: float(x)}) for x in deviation]
    values, errors = (np.array([getattr(ripple, name) for ripple in ripples]) for name in ("value", "error"))
    return RippleCurve(deviation=deviation, peak_to_peak=values, error=errors, carrying=_carrying(table))


def _carrying(table: SteDatabase) -> FloatArray:
    """Return the mean number of pairs that carry at each deviation of a table over one of them, (N,)."""
    share = table.load_share[:, 0]  # (P, M, D, pairs) at the one load
    pairs = np.sum(share > 0.0, axis=-1).reshape(share.shape[0], -1)  # (P, N): M or D is 1
    ahead = np.append(table.position[1:], table.position[0] + table.period) - table.position
    weight = 0.5 * (ahead + np.roll(ahead, 1))  # trapezoidal rule over the period
    return np.asarray(weight @ pairs / table.period)
