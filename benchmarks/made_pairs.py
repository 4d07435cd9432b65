"""Are 10 000 pairs of class 6 by a model distributed as pairs that are solved one by one?"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.figures import Figure
from benchmarks.quiet_helical_cases import QuietPair, quiet_pairs
from fe_contact import AnalysisOptions, Run
from fe_contact.microgeometry.tolerance_study import Sampling, ToleranceStudy, scatter
from fe_contact.microgeometry.tolerances import iso1328_tolerances
from fe_contact.types import FloatArray
from host import cpu_seconds
from host.directories import cache_home
from model_studies.spread import quantile_bounds

SUBJECT = "10 000 pairs of class 6 by a model against 300 solved ones"
PAIRS = ("23/67, 22 deg", "25/52, 28 deg", "21/59, 24 deg", "28/45, 23 deg")
PAIRS_BY_MODEL, PAIRS_SOLVED, CONFIDENCE = 10_000, 300, 0.95
FRACTIONS = (0.05, 0.25, 0.5, 0.75, 0.95)
MISALIGNMENT = 5e-6
"""Tolerance of the assembly, m."""


class HeldQuantiles(NamedTuple):
    """Quantiles of one pair at L loads: by the model, and the bounds of the solved sample, (K, L) in m.

    The bounds are those of a sample of `PAIRS_SOLVED` other pairs. They are free of a distribution.
    """

    model: FloatArray
    low: FloatArray
    high: FloatArray
    missed: FloatArray
    seconds: float
    solved_seconds: float

    @property
    def outside(self) -> FloatArray:
        """Whether the model lies outside (K, L)."""
        return np.asarray((self.model < self.low) | (self.model > self.high))


def figures() -> list[Figure]:
    """Return how many quantiles lie outside their band, and what a pair costs."""
    assessments = [assessed(case) for case in quiet_pairs() if case.name in PAIRS]
    outside = np.array([each.outside for each in assessments])
    widths = np.array([(each.high - each.low) / each.model for each in assessments])
    missed = np.concatenate([each.missed for each in assessments])
    by_model = sum(each.seconds for each in assessments) / len(assessments)
    one_by_one = sum(each.solved_seconds for each in assessments) / len(assessments)
    within = 100.0 * (1.0 - CONFIDENCE)
    beyond, width = 100.0 * float(outside.mean()), 100.0 * float(np.median(widths))
    return [
        Figure(SUBJECT, f"quantiles outside their band, of {outside.size}", beyond, "%", within),
        Figure(SUBJECT, "width of the band, median", width, "%"),
        Figure(SUBJECT, "a pair by the model, rms missed at most", 1e6 * float(missed.max()), "um"),
        Figure(SUBJECT, "10 000 pairs, the 300 solved ones among them", by_model, "CPU s"),
        Figure(SUBJECT, "300 pairs solved", one_by_one, "CPU s"),
    ]


def assessed(case: QuietPair) -> HeldQuantiles:
    """Compare the quantiles of a pair by the model with those of pairs that are all solved."""
    model, seconds = _drawn(case, PAIRS_BY_MODEL, seed=1)
    solved, solved_seconds = _drawn(case, PAIRS_SOLVED, seed=2)
    ends = [quantile_bounds(solved.peak_to_peak, fraction, CONFIDENCE)[1:] for fraction in FRACTIONS]
    low, high = (np.array(each) for each in zip(*ends, strict=True))
    by_model = np.quantile(model.peak_to_peak, FRACTIONS, axis=0)
    return HeldQuantiles(by_model, low, high, model.missed, seconds, solved_seconds)


def _drawn(case: QuietPair, samples: int, seed: int) -> tuple[ToleranceStudy, float]:
    """Draw pairs of class 6, of which at most `PAIRS_SOLVED` are solved; CPU seconds with bodies at hand."""
    tolerances = iso1328_tolerances(case.pair, 6, misalignment=MISALIGNMENT)
    sampling = Sampling(samples, seed, exact=PAIRS_SOLVED, fractions=FRACTIONS)
    options = AnalysisOptions(level="draft")
    began = cpu_seconds()
    study = scatter(
        case.pair,
        case.torques,
        tolerances,
        sampling,
        options,
        Run(cache=cache_home()),
        misalignment=case.misalignment,
    )
    return study, cpu_seconds() - began
