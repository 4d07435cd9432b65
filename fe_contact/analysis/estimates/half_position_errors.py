"""Errors between even positions, measured by leaving half of them out, without a further solution.

Curves through every second position are compared with those through all. From this change follows the error
that all positions leave. Corners between the positions, which the change may miss, are estimated separately.
"""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.estimates.position_errors import NEXT_SPACING, PositionErrors, predicted_failure
from fe_contact.ste.curve_quantities import PEAK_TO_PEAK, peak_excess, quantity_changes
from fe_contact.ste.interpolation import Axis
from fe_contact.types import FloatArray

LEFT_BY_HALF = 0.75
"""Error of all positions over the change by half of them: 1/3 for second order, more for kinks."""

PASSED_BY = 1.25
"""Missed peak-to-peak over the height of the corners at which the chords of neighboring intervals meet:
flanks bend towards them. Both factors were set on the pairs of docs/lab/index.md ("Constants"), against eight
times as many positions on the same meshes.
"""


def errors_by_halves(knots: FloatArray, values: FloatArray, period: int) -> PositionErrors:
    """Estimate the errors between even positions from the solutions at these positions alone.

    Parameters
    ----------
    knots : ndarray, shape (K,)
        Positions in base pitches, equally spaced in [0, period).
    values : ndarray, shape (K, F)
        STE in m; NaN where a solution failed.
    period : int
        Period of the curves in base pitches.

    Returns
    -------
    PositionErrors
        Bands (K, F) by how far the neighbors of a position miss it; errors of the curves (23, F) by the
        larger change of the two halves.
    """
    first = quantity_changes(knots[::2], values[::2], values, period, knots)
    second = quantity_changes(knots[1::2], values[1::2], values, period, knots)
    curves = LEFT_BY_HALF * np.maximum(first, second)
    curves[PEAK_TO_PEAK] = np.maximum(curves[PEAK_TO_PEAK], PASSED_BY * peak_excess(knots, values, period))
    predicted = NEXT_SPACING * predicted_failure(Axis(knots, float(period)), values)
    nearby = np.maximum(predicted, np.maximum(np.roll(predicted, 1, axis=0), np.roll(predicted, -1, axis=0)))
    return PositionErrors(nearby, curves)
