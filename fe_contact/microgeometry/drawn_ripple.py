"""The ripple of pairs drawn within tolerances, on bodies in memory.

Some of the pairs are solved; the curves of the others follow from tangents, their derivatives by the
deviations. The method is that of a tolerance Monte Carlo, in parts that are short enough for a live answer.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.errors import InputError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.curve_derivatives import acts
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.linearized_design import linearized
from fe_contact.microgeometry.objective import NO_LIMITS
from fe_contact.microgeometry.scatter import ONE_NODE
from fe_contact.microgeometry.tangent_model import TangentModel, order_amplitude
from fe_contact.microgeometry.tolerance_study import curves_of_samples, tangents_about
from fe_contact.microgeometry.tolerances import Tolerances
from fe_contact.types import FloatArray
from model_studies.spread import quantile_bounds, quantiles

DRAWN = 1000
"""Number of drawn pairs."""
SOLVED = 16
"""Number of solved pairs: ends of a band are off by 12 % of its width with 8, 8 % with 16, 3 % with 64."""
IN_A_PART = 4
"""Number of pairs solved together, in a fifth of a second; those of the first part have tangents."""
FRACTIONS = 0.05, 0.95
"""Fractions of the pairs below the ends of a band."""
CONFIDENCE = 0.95
"""Confidence of the bounds of these quantiles."""


@dataclass(frozen=True)
class Spread:
    """Range of a quantity over nine of ten pairs, and the error of its ends, m."""

    low: float
    high: float
    error: float


@dataclass(frozen=True)
class RippleBand:
    """Ripple of nine of ten pairs at one torque."""

    position: FloatArray
    """Position, base pitches. Shape (P,)."""
    low: FloatArray
    high: FloatArray
    """`low`, `high`: Least and largest transmission error less its mean, m. Shape (P,) each."""
    peak_to_peak: Spread
    first_harmonic: Spread


@dataclass(frozen=True)
class DrawnRipple:
    """Pairs drawn within their tolerances, and the solutions of those that are solved so far."""

    evaluator: Evaluator
    """Evaluator of the pair as designed."""
    names: tuple[str, ...]
    """Names of the quantities that deviate."""
    deviation: FloatArray
    """Deviations of the pairs, m. Shape (N, d)."""
    model: TangentModel | None = None
    """Model of the other pairs; None before the first part is solved."""
    ste: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    """Transmission error of the solved pairs, m. Shape (n, P, 1)."""

    @classmethod
    def of(
        cls,
        bodies: CondensedPair,
        pair: ParallelAxes,
        torque: float,
        tolerances: Tolerances,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
        seed: int = 0,
    ) -> DrawnRipple:
        """Draw pairs within `tolerances` about a pair of given flanks and alignment.

        Positions are those of a preview, every other one of a table. Raises `InputError` as
        `CondensedPair.table`, or for teeth that differ, or for an effect of the flanks that is off.
        """
        problem = bodies.contact_problem(pair, np.array([torque]), misalignment, center_distance_change)
        if problem.checked.model.period > 1:
            bound = "left out where teeth differ"
            raise InputError("tolerance_class", "a class", bound, "For those, loa scatter draws pairs.")
        if not all(acts(name, problem.checked) for name in tolerances.widths):
            bound = "left out where effects of the flanks are off"
            raise InputError("tolerance_class", "a class", bound, "Leave them at auto.")
        evaluator = Evaluator(
            problem.contacts.fine,
            problem.checked.request.choices,
            position=problem.nodes.position[::2],
            load=problem.plan.load,
            misalignment=np.array([misalignment]),
            nodes=ONE_NODE,
        )
        return cls(evaluator, tuple(tolerances.widths), tolerances.sample(DRAWN, seed))

    @property
    def solved(self) -> int:
        """Number of the pairs that are solved."""
        return len(self.ste)

    @property
    def missing(self) -> int:
        """Number of the pairs that are still to be solved for a band."""
        return SOLVED - self.solved

    def further(self) -> DrawnRipple:
        """Solve further pairs, `IN_A_PART` of them; the first part gets tangents, too.

        Raises `SolveError`: the contact of a pair cannot be solved.
        """
        part = self.deviation[self.solved : self.solved + IN_A_PART]
        is_first = self.model is None
        ste, derivatives = curves_of_samples((self.evaluator, self.names), (is_first, part))
        if not np.isfinite(ste).all():
            raise SolveError("the contact of a pair within the tolerances cannot be solved", ste)
        if not is_first or derivatives is None:
            return replace(self, ste=np.concatenate([self.ste, ste]))
        design = linearized(self.evaluator, {}, self.names, NO_LIMITS)
        nominal = np.zeros((1, len(self.names)))
        tangents = tangents_about(self.evaluator, self.names, nominal, design.evaluation.ste, design.curves)
        pair_tangents = tangents_about(self.evaluator, self.names, part, ste, derivatives)
        return replace(self, ste=ste, model=tangents.with_further(pair_tangents))

    def band(self) -> RippleBand:
        """Return the band of all pairs, once `SOLVED` are solved.

        The solved pairs without tangents correct the model and show its error. An error combines the bounds
        of the quantiles of `DRAWN` pairs with the root mean square error of the model.
        """
        assert self.model is not None
        known = self.deviation[IN_A_PART : self.solved]
        solved = self.ste[IN_A_PART:]
        model = self.model.corrected(known, solved)
        curves, predicted = (np.concatenate(list(model.curves(values))) for values in (self.deviation, known))
        level = curves[..., 0] - curves[..., 0].mean(axis=1, keepdims=True)
        low, high = quantiles(level, FRACTIONS)

        def spread(every_pair: FloatArray, by_model: FloatArray, by_contact: FloatArray) -> Spread:
            # each end with the bounds of its confidence
            ends = [quantile_bounds(every_pair, fraction, CONFIDENCE) for fraction in FRACTIONS]
            lowest, highest = (float(value[0]) for value, _, _ in ends)
            half_bounds = max(float(0.5 * (above - below)[0]) for _, below, above in ends)
            model_error = float(np.sqrt(np.mean((by_model - by_contact) ** 2)))
            return Spread(lowest, highest, error=float(np.hypot(half_bounds, model_error)))

        ripple = (np.ptp(values, axis=1) for values in (curves, predicted, solved))
        first_harmonic = (order_amplitude(values, 1, 1) for values in (curves, predicted, solved))
        return RippleBand(self.evaluator.position, low, high, spread(*ripple), spread(*first_harmonic))
