"""The result of a study of scenes: the figures of every run, and what they say together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dynamics.results.array_file import ArrayFile, Stored
from dynamics.types import FloatArray, IntArray, Json
from model_studies.spread import quantile_bounds, rank_correlation

FRACTIONS = (0.05, 0.5, 0.95)
POINT = ("point",)


@dataclass(frozen=True)
class Spread:
    """The distribution of a response over the samples of each of C combinations of grid and list.

    Attributes
    ----------
    mean, standard_error : (C,) arrays
        Of the usable samples; NaN where there are fewer than one, or two.
    fraction : (Q,) array
    quantile, low, high : (C, Q) arrays
        Estimates and confidence bounds, infinite where the sample is too small for a bound.
    """

    mean: FloatArray
    standard_error: FloatArray
    fraction: FloatArray
    quantile: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class Study(ArrayFile):
    """The figures of N runs: f factors, r responses.

    Attributes
    ----------
    factor, kind : tuples of str
        Names of the factors, and "grid", "list", "normal" or "uniform".
    response, unit : tuples of str
        Titles and SI units of the responses.
    value : (N, f) array
        Of the factors, in the units of their names.
    figure, error : (N, r) arrays
        Responses, and their errors where the run states them, else NaN. Of a failed run all are NaN.
    reason : tuple of str
        Why a run has no figures; empty where it has.
    seconds : (N, 2) array
        CPU time of each run in all, and wall time of its integration, s.
    samples : int
        Of each combination of grid and list, in a row.
    confidence : float
        Of the bounds of quantiles.
    worst : (k,) int array
        Points whose first response is largest, which are kept as full runs.
    facts : dict
        Plain JSON: design, start, receipt, what the runs do without.
    """

    factor: tuple[str, ...]
    kind: tuple[str, ...]
    response: tuple[str, ...]
    unit: tuple[str, ...]
    value: FloatArray
    figure: FloatArray
    error: FloatArray
    reason: tuple[str, ...]
    seconds: FloatArray
    samples: int
    confidence: float
    worst: IntArray
    facts: Json

    SCHEMA: ClassVar[str] = "lineofaction study"
    ARRAYS: ClassVar[Mapping[str, Stored]] = {
        "value": Stored(("point", "factor"), "", "values of the factors, in the units of their names"),
        "figure": Stored(("point", "response"), "", "responses, in their SI units"),
        "error": Stored(("point", "response"), "", "stated errors of the responses"),
        "seconds": Stored(("point", "cost"), "s", "CPU time in all, wall time of the integration"),
        "worst": Stored(("kept",), "", "points kept as full runs"),
    }

    @property
    def usable(self) -> int:
        """Number of runs that have figures."""
        return sum(not reason for reason in self.reason)

    def column(self, response: int) -> FloatArray:
        """Return a response (C, samples) by combination and sample."""
        return self.figure[:, response].reshape(-1, self.samples)

    def spread(self, response: int) -> Spread:
        """Return the distribution of a response over the samples of each combination."""
        rows = [row[np.isfinite(row)] for row in self.column(response)]
        bounds = [[_bounds(row, fraction, self.confidence) for fraction in FRACTIONS] for row in rows]
        quantile, low, high = np.moveaxis(np.array(bounds), -1, 0)
        return Spread(
            np.array([row.mean() if row.size else np.nan for row in rows]),
            np.array([row.std(ddof=1) / np.sqrt(row.size) if row.size > 1 else np.nan for row in rows]),
            np.array(FRACTIONS),
            quantile,
            low,
            high,
        )

    def level_means(self, factor: int, response: int) -> tuple[FloatArray, FloatArray]:
        """Return the values of a factor of grid or list, and the mean response over all else at each."""
        values = np.unique(self.value[:, factor])
        column = self.figure[:, response]
        here = (column[(self.value[:, factor] == value) & np.isfinite(column)] for value in values)
        return values, np.array([part.mean() if part.size else np.nan for part in here])

    def swing(self, factor: int, response: int) -> float:
        """Return what a factor of the grid or the list does: the spread of the means of its levels."""
        means = self.level_means(factor, response)[1]
        return float(np.nanmax(means) - np.nanmin(means)) if np.isfinite(means).any() else float("nan")

    def correlation(self, response: int) -> FloatArray:
        """Return Spearman's rank correlation (f,) of sampled factors with a response, NaN for the others.

        Taken within each combination of grid and list, and the mean over them.
        """
        sampled = [k for k, kind in enumerate(self.kind) if kind in ("normal", "uniform")]
        result, rows = np.full(len(self.factor), np.nan), []
        if not sampled:
            return result
        about = np.median(self.value[:, sampled], axis=0)
        values = (self.value[:, sampled] - about).reshape(-1, self.samples, len(sampled))
        for deviation, column in zip(values, self.column(response), strict=True):
            usable = np.isfinite(column)
            if np.count_nonzero(usable) > 2:
                rows.append(rank_correlation(deviation[usable], column[usable, None])[:, 0])
        if rows:
            result[sampled] = np.mean(rows, axis=0)
        return result


def _bounds(row: FloatArray, fraction: float, confidence: float) -> tuple[float, float, float]:
    """Quantile and bounds of the usable samples of one combination."""
    if not row.size:
        return float("nan"), -np.inf, np.inf
    value, low, high = quantile_bounds(row[:, None], fraction, confidence)
    return float(value[0]), float(low[0]), float(high[0])
