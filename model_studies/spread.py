"""Spread of a sample: quantiles with bounds that assume no shape of the distribution, rank correlation."""

from __future__ import annotations

import warnings

import numpy as np

from bounds.types import FloatArray


def quantiles(sample: FloatArray, fractions: float | tuple[float, ...]) -> FloatArray:
    """Return the values that further members are below with given probabilities, by samples (N, ...).

    NaN of the sample are left out; NaN where none is left.

    Notes
    -----
    A further member falls below the k-th of N with the probability k / (N + 1), whatever the distribution:
    between the 5 % and 95 % so estimated lie 90 % of the others, where ranks k / N hold 85 % of them by 32.
    """
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # nothing left
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
    """Return Spearman's rank correlation (d, L) of each deviation or of its size, whichever is more.

    `deviation` (N, d) is taken from the design, `sample` (N, L) follows it. A response may grow to both sides
    of a design, so the size of a deviation counts as well as its value.
    """
    from scipy.stats import rankdata  # noqa: PLC0415 (start-up time)

    ranks = rankdata(sample, axis=0)
    signed, sized = (_correlation(rankdata(x, axis=0), ranks) for x in (deviation, np.abs(deviation)))
    return np.where(np.abs(sized) > np.abs(signed), sized, signed)


def _correlation(first: FloatArray, second: FloatArray) -> FloatArray:
    a, b = (x - x.mean(axis=0) for x in (first, second))
    scale = np.sqrt(np.outer((a**2).sum(axis=0), (b**2).sum(axis=0)))
    return np.asarray(np.divide(a.T @ b, scale, out=np.zeros_like(scale), where=scale > 0.0))
