"""Samples of an axis at which errors are measured, and interpolation of the errors between them.

The errors of a discretization are nearly a fixed part of the deflection. So they can be interpolated linearly
between loads that differ by a factor of several, and between alignments. One digit of an error is enough.
"""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray, IntArray

LOADS, ALIGNMENTS = 3, 5
"""Largest number of nodes that are solved of an axis of loads, and of misalignments or center distances."""
WIDE_INTERVALS, WIDE_PROBES = 4, 3
"""An axis of loads with at most `WIDE_INTERVALS` intervals has `WIDE_PROBES` held-out loads in each; one with
more has one in each, as they are shorter."""
FEWEST_POSITIONS = 32
"""Positions at which a table is solved again, at least, if it has as many."""


def sampled_positions(count: int) -> IntArray:
    """Return at least `FEWEST_POSITIONS` of `count` positions, every k-th from the first.

    So the sample is dense where the positions are.
    """
    return np.arange(0, count, max(count // FEWEST_POSITIONS, 1))


def sample_of(count: int, maximum: int) -> IntArray:
    """Return the nodes of an axis of `count` that are solved: at most `maximum`, both ends among them."""
    return np.unique(np.linspace(0, count - 1, min(count, maximum)).round().astype(np.int64))


def spread_around(knots: FloatArray, period: int, sample: IntArray, values: FloatArray) -> FloatArray:
    """Interpolate values (k, ...) known at some knots of a closed axis to all of them, linearly.

    `sample` begins with 0; `knots` (n,) increase in [0, period).
    """
    around = np.append(knots, knots[0] + period)
    return spread(around, np.append(sample, knots.size), np.concatenate([values, values[:1]]), 0)[:-1]


def spread(nodes: FloatArray, sample: IntArray, values: FloatArray, axis: int) -> FloatArray:
    """Interpolate values known at some nodes of an axis to all of them, linearly.

    Parameters
    ----------
    nodes : ndarray, shape (n,)
        Increasing.
    sample : ndarray of int, shape (k,)
        Nodes of `values`, both ends among them.
    values : ndarray
        k long along `axis`; NaN goes to both intervals beside it.

    Returns
    -------
    ndarray
        n long along `axis`; the values themselves where all nodes are solved.
    """
    if sample.size == nodes.size:
        return values
    abscissa = nodes[sample]
    right = np.clip(np.searchsorted(abscissa, nodes), 1, sample.size - 1)
    part = (nodes - abscissa[right - 1]) / (abscissa[right] - abscissa[right - 1])
    weight = part.reshape([-1 if i == axis % values.ndim else 1 for i in range(values.ndim)])
    low, high = np.take(values, right - 1, axis=axis), np.take(values, right, axis=axis)
    return np.asarray(
        np.where(weight == 0.0, low, np.where(weight == 1.0, high, low + weight * (high - low)))
    )
