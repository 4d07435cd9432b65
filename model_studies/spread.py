"""Spread of a sample: quantiles with bounds that assume no shape of the distribution, rank correlation.

Axes: N members of the sample, L quantities (one a load, in tables), d deviations.
"""

from __future__ import annotations

import warnings

import numpy as np

from bounds.types import FloatArray


def quantiles(sample: FloatArray, fractions: float | tuple[float, ...]) -> FloatArray:
    """Return the quantiles of a sample (N, ...): further members fall below with these probabilities.

    NaN of the sample are left out; NaN where none is left.

    Notes
    -----
    A further member falls below the k-th of N with the probability k / (N + 1), whatever the distribution. So
    90 % of further members lie between the estimated 5 % and 95 % quantiles. Ranks k / N would enclose only
    85 % with a sample of 32.
    """
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # all NaN
        return np.asarray(np.nanquantile(sample, fractions, axis=0, method="weibull"))


def quantile_bounds(
    sample: FloatArray, fraction: float, confidence: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Estimate a quantile of samples (N, L) with distribution-free bounds.

    Returns
    -------
    value, low, high : (L,) arrays
        Estimate and bounds; infinite where the sample is too small for a bound.

    Notes
    -----
    The number of samples below the quantile is binomial, so two order statistics enclose it with at least the
    given confidence, whatever the distribution (Conover: Practical Nonparametric Statistics, 3.2).
    """
    from scipy.stats import binom  # noqa: PLC0415 (start-up time)

    count, loads = sample.shape
    ordered = np.sort(sample, axis=0)
    outside = 0.5 * (1.0 - confidence)
    below = int(binom.ppf(outside, count, fraction))
    above = int(binom.ppf(1.0 - outside, count, fraction)) + 1
    low = ordered[below - 1] if below >= 1 else np.full(loads, -np.inf)
    high = ordered[above - 1] if above <= count else np.full(loads, np.inf)
    return quantiles(sample, fraction), low, high


def rank_correlation(deviation: FloatArray, sample: FloatArray) -> FloatArray:
    """Return Spearman's rank correlation (d, L) of the responses with each deviation or with its size.

    Of both the stronger is returned: a response may grow to both sides of the design. `deviation` (N, d)
    counts from the design, `sample` (N, L) is the response.
    """
    ranks = _ranks(sample)
    signed, sized = (_correlation(_ranks(x), ranks) for x in (deviation, np.abs(deviation)))
    return np.where(np.abs(sized) > np.abs(signed), sized, signed)


def _ranks(sample: FloatArray) -> FloatArray:
    """Return the ranks of entries (N, k) in their columns, from 1; equal ones share the mean of theirs."""
    below, at_most = ([np.searchsorted(np.sort(x), x, side) for x in sample.T] for side in ("left", "right"))
    return np.asarray(0.5 * (np.array(below) + np.array(at_most) + 1.0).T)


def _correlation(first: FloatArray, second: FloatArray) -> FloatArray:
    a, b = (x - x.mean(axis=0) for x in (first, second))
    scale = np.sqrt(np.outer((a**2).sum(axis=0), (b**2).sum(axis=0)))
    return np.asarray(np.divide(a.T @ b, scale, out=np.zeros_like(scale), where=scale > 0.0))
