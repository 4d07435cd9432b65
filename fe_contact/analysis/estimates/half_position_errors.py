"""Errors between even positions, measured by leaving half of them out, without a further solution.

Curves through every second position are held against those through all. What the second half changed is
carried on to what a third would; corners between the positions, which it may have passed by, are looked for
by themselves.
"""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.estimates.position_errors import NEXT_SPACING, PositionErrors, predicted_failure
from fe_contact.ste.curve_quantities import PEAK_TO_PEAK, peak_excess, quantity_changes
from fe_contact.ste.interpolation import Axis
from fe_contact.types import FloatArray

LEFT_BY_HALF = 0.75
"""Error of all positions over the change by leaving half of them out: 1/3 for second order, and more for
kinks, which may lie anywhere in an interval.
"""

PASSED_BY = 1.25
"""Missed peak-to-peak over the height of the corners at which the chords of neighboring intervals meet:
flanks bend towards them. Both factors were set on the pairs of docs/lab/index.md ("Constants"), against eight
times as many positions on the same meshes.
"""


def errors_by_halves(knots: FloatArray, values: FloatArray, period: int) -> PositionErrors:
    """Assess even positions by themselves.

    Parameters
    ----------
    knots : ndarray, shape (K,)
        Base pitches, equally spaced in [0, period).
    values : ndarray, shape (K, F)
        STE in m; NaN where a solution failed.
    period : int
        Base pitches.

    Returns
    -------
    PositionErrors
        Bands (K, F) from what each position's neighbors miss of it; of the curves (23, F) the larger change
        of the two halves.
    """
    halves = slice(0, None, 2), slice(1, None, 2)
    changes = (quantity_changes(knots[half], values[half], values, period, knots) for half in halves)
    change = np.maximum(*changes)
    curves = LEFT_BY_HALF * change
    curves[PEAK_TO_PEAK] = np.maximum(curves[PEAK_TO_PEAK], PASSED_BY * peak_excess(knots, values, period))
    predicted = NEXT_SPACING * predicted_failure(Axis(knots, float(period)), values)
    nearby = np.maximum(predicted, np.maximum(np.roll(predicted, 1, axis=0), np.roll(predicted, -1, axis=0)))
    return PositionErrors(nearby, curves)
