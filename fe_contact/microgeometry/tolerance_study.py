"""Tolerance Monte Carlo: the distribution of peak-to-peak STE over pairs as they are made and assembled.

N pairs are drawn with d deviations each, and their ripple (peak-to-peak STE) is found at L torques. The first
pairs are solved. The others follow from a *model*: the lowest of several *tangents*, first-order expansions
of the STE about solved pairs and about the design. Solved pairs without a tangent check and correct it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from bounds import MAX_BYTES, at_most
from bounds.brief import brief
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import InputError, SolveError, integer, within
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.confirmation import full_table, ripple_errors
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.drawn_teeth import ToothTolerances
from fe_contact.microgeometry.evaluator import Evaluator, least_deviation
from fe_contact.microgeometry.linearized_design import linearized
from fe_contact.microgeometry.objective import NO_LIMITS
from fe_contact.microgeometry.order_limit import (
    DrawnPairs,
    OrderLimit,
    PairsAbove,
    as_spread,
    mesh_order_above,
)
from fe_contact.microgeometry.scatter import (
    MISALIGNMENT,
    ONE_NODE,
    GaussHermite,
    Scatter,
    ScatterNodes,
    SobolSample,
)
from fe_contact.microgeometry.sidebands_above import MadePairs, sidebands_above
from fe_contact.microgeometry.tangent_model import TangentModel
from fe_contact.microgeometry.tolerances import Tolerances
from fe_contact.microgeometry.variables import figure
from fe_contact.options import AnalysisOptions, Levels, Run
from fe_contact.types import FloatArray, Json
from model_studies import in_unit
from model_studies.record import under_key
from model_studies.result_record import ResultRecord
from model_studies.spread import quantile_bounds, rank_correlation
from model_studies.stage_clock import StageClock

TANGENTS = 64
"""Most pairs about which tangents are taken, besides the design."""
IN_A_TASK = 25
"""Pairs of a task, which takes half a second to some seconds. The number is the same for any workers, so that
results are equal to the last bit."""
ACTING = SobolSample(1)
"""A sample of two pairs in which every deviation differs from zero: effects are decided for these."""


@dataclass(frozen=True)
class Quantile:
    """A quantile of peak-to-peak at each of L torques."""

    fraction: float
    """Part of all pairs whose ripple lies below the quantile."""
    value: FloatArray = field(metadata=in_unit("m", "torque"))
    low: FloatArray = field(metadata=in_unit("m", "torque"))
    high: FloatArray = field(metadata=in_unit("m", "torque"))
    """`value`, `low`, `high`: Estimate and confidence bounds, m; infinite or zero where the sample is too
    small for a bound. Shape (L,) each.
    """


def estimated_quantile(sample: FloatArray, fraction: float, confidence: float) -> Quantile:
    """Estimate a quantile of samples (N, L) of lengths with distribution-free bounds."""
    value, low, high = quantile_bounds(sample, fraction, confidence)
    return Quantile(fraction, value, np.maximum(low, 0.0), high)


@dataclass(frozen=True)
class Sampling:
    """A sample of pairs and its quantiles."""

    samples: int = 1000
    """Number of pairs, 2 to 1 000 000."""
    seed: int = 0
    """Seed of the sample. Equal seeds give equal results to the last bit, with any workers."""
    confidence: float = 0.95
    """Confidence of the bounds of the quantiles."""
    fractions: Sequence[float] = (0.05, 0.5, 0.95)
    """Quantiles to estimate, as fractions of all pairs."""
    positions: int = 64
    """Number of equally spaced positions in a base pitch."""
    exact: int = 300
    """Number of pairs that are solved. Of these some have tangents for the model of further pairs; the
    others check the model.
    """

    def __post_init__(self) -> None:
        integer("samples", self.samples, 2, 1_000_000)
        integer("exact", self.exact, 2, 1_000_000)
        integer("seed", self.seed, 0, 2**63 - 1)
        within("confidence", self.confidence, 0.5, 0.9999)
        for index, fraction in enumerate(self.fractions):
            within(f"fractions[{index}]", fraction, 0.0, 1.0)

    @property
    def solved(self) -> int:
        """Number of pairs that are solved."""
        return min(self.samples, self.exact)

    @property
    def tangents(self) -> int:
        """Number of solved pairs about which tangents are taken."""
        return min(TANGENTS, max(1, self.solved // 4))


@dataclass(frozen=True)
class WithinClass:
    """Figures of the pairs of a tolerance class at L torques, beside a study of measured gears."""

    mean: FloatArray = field(metadata=in_unit("m", "torque"))
    """Mean peak-to-peak STE, m. Shape (L,)."""
    share: FloatArray
    """Share of the pairs above the limit. Shape (L,), or (0,) without a limit."""
    decides: str
    """Name of the deviation that contributes most to pairs above the limit, or empty."""

    @classmethod
    def of(cls, study: ToleranceStudy) -> WithinClass:
        """Return the figures of a study within a class."""
        above = study.above
        if above is None:
            return cls(study.mean, np.zeros(0), "")
        return cls(study.mean, above.share, above.names[above.decides])


@brief
@dataclass(frozen=True)
class ToleranceStudy(ResultRecord):
    """Peak-to-peak of N pairs at L torques."""

    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    """Torque, N m. Shape (L,)."""
    names: tuple[str, ...]
    """Names of the deviations: "misalignment" and ``gear.quantity``."""
    deviation: FloatArray = field(metadata=in_unit("m", "sample", "deviating"))
    """Deviations of the pairs, m. Shape (N, d)."""
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "sample", "torque"))
    """Peak-to-peak STE of the pairs, m. Shape (N, L)."""
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    error: FloatArray = field(metadata=in_unit("m", "torque"))
    """`nominal`, `error`: Peak-to-peak STE without deviations, and the error of its analysis, m. Shape (L,)
    each.
    """
    quantiles: tuple[Quantile, ...]
    first_order: FloatArray = field(metadata=in_unit("m", "sample", "torque"))
    """Peak-to-peak of the same pairs from the nominal curves and their derivatives, m. Shape (N, L)."""
    confidence: float
    """Confidence of the bounds of the quantiles."""
    cost: Json
    """CPU and wall seconds by stage, of this process."""
    request: Json = field(metadata=under_key("asked"))
    solved: int = 0
    """Number of pairs, the first ones, that are solved; the model gives the others."""
    held: int = 0
    """Number of solved pairs that have no tangent, and check the model."""
    missed: FloatArray = field(default_factory=lambda: np.zeros(0), metadata=in_unit("m", "torque"))
    missed_largest: FloatArray = field(default_factory=lambda: np.zeros(0), metadata=in_unit("m", "torque"))
    """`missed`, `missed_largest`: Error of the model in the peak-to-peak of the `held` pairs, root mean
    square and largest, m. Shape (L,) each.
    """
    above: PairsAbove | None = None
    """Pairs above a limit."""
    within_class: WithinClass | None = None
    """Figures of the pairs of a class, if the study is of measured gears."""

    @property
    def mean(self) -> FloatArray:
        """Mean (L,), m."""
        return np.asarray(self.peak_to_peak.mean(axis=0))

    @property
    def mean_error(self) -> FloatArray:
        """Standard error of the mean (L,), m."""
        return np.asarray(self.peak_to_peak.std(axis=0, ddof=1) / np.sqrt(self.peak_to_peak.shape[0]))

    @property
    def influence(self) -> FloatArray:
        """Rank correlation (d, L) of each deviation with the ripple."""
        return rank_correlation(self.deviation, self.peak_to_peak)


def scatter(
    pair: ParallelAxes,
    torques: Levels,
    tolerances: Tolerances,
    sampling: Sampling = Sampling(),
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    misalignment: float = 0.0,
    limit: OrderLimit | None = None,
) -> ToleranceStudy:
    """Sample pairs within their tolerances and find the peak-to-peak transmission error of each.

    Raises `InputError`: a value that cannot be used, by field name; `MeshError`, `SolveError`: no acceptable
    mesh, or the contact of a pair cannot be solved.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        As designed.
    torques : sequence of float
        N m on the driving gear, increasing.
    tolerances : Tolerances
        See `iso1328_tolerances`. Material removed does not become negative by a deviation.
    sampling : Sampling
    options : AnalysisOptions
        One model for all pairs; `positions`, `receipt` and `on_violation` are ignored.
    run : Run
        Its workers run tasks of 25 pairs.
    misalignment : float
        As designed, m.
    limit : OrderLimit, optional
        Pairs above it are counted. An order other than a mesh order needs `sampled`, which takes `teeth`.
    """
    request = ToleranceRequest(pair, torques, tolerances, sampling, options, misalignment, limit)
    return sampled(request, run)


@dataclass(frozen=True)
class ToleranceRequest:
    """Request of `scatter`, with the differences of `teeth` where the limit is on an order of one gear."""

    pair: ParallelAxes
    torques: Levels
    tolerances: Tolerances
    sampling: Sampling
    options: AnalysisOptions
    misalignment: float
    limit: OrderLimit | None = None
    teeth: ToothTolerances | None = None

    @property
    def space(self) -> DesignSpace:
        """The pairs that the tolerances allow, as designs in which every toleranced figure deviates."""
        rule = ACTING if self.tolerances.misalignment else GaussHermite(1)  # one node: no scatter
        deviations = Scatter(self.tolerances.misalignment, self.tolerances.modification, rule)
        return DesignSpace(
            self.pair, {}, deviations, self.misalignment, self.sampling.positions, self.options
        )

    @cached_property
    def checked(self) -> Checked:
        """The checked request; nothing is computed. Raises `InputError`, also if it needs too much memory."""
        if self.limit is not None:
            self.limit.check(self.pair, self.sampling.positions)
            if self.limit.gear and self.teeth is None:
                remedy = "State how much they differ: `iso1328_tooth_tolerances`."
                raise InputError("limit.gear", self.limit.name, "a mesh order where teeth are alike", remedy)
        checked = self.space.check(self.torques)
        self._require_memory(checked.model.period)
        return checked

    def _require_memory(self, period: int) -> None:
        """Raise `InputError` if the curves of the solved pairs and their tangents need too much memory."""
        sampling, deviating = self.sampling, len(self.tolerances.widths)
        curve = 8 * period * sampling.positions * len(self.torques)  # bytes of the curves of one pair
        # three copies of the curves, and two of each derivative
        needed = curve * (3 * sampling.solved + 2 * (sampling.tangents + 1) * deviating)
        if needed > MAX_BYTES:
            size = f"{sampling.solved} pairs over {period} base pitches, {needed / 1e9:.1f} GB"
            remedy = "Analyze fewer pairs whole, fewer torques, or a shorter period."
            raise InputError("exact", size, at_most(MAX_BYTES / 1e9, "GB"), remedy)


def sampled(request: ToleranceRequest, run: Run) -> ToleranceStudy:
    """Sample pairs within tolerances; see `scatter`."""
    clock, tolerances, sampling = StageClock(run.workers.cost), request.tolerances, request.sampling
    study = design_study(request.space, request.torques, [], clock, run, request.checked)
    deviation = tolerances.sample(sampling.samples, sampling.seed)
    names, nominal = tuple(tolerances.widths), replace(study.evaluator, nodes=ONE_NODE)
    with clock.stage("first order"):
        design = linearized(nominal, {}, names, NO_LIMITS)
        about_design = tangents_about(
            nominal, names, np.zeros((1, len(names))), design.evaluation.ste, design.curves
        )
        at_once = about_design.peak_to_peak(deviation)
    run.progress("first order", 1.0)
    with clock.stage("samples"):
        ste, tangents = _solved(study.evaluator, names, deviation[: sampling.solved], sampling, run)
        model = about_design.with_further(tangents)
        unknown = slice(sampling.tangents, sampling.solved)
        model = model.corrected(deviation[unknown], ste[unknown])
    with clock.stage("model"):
        ripple, model_error = _ripple(model, deviation, ste, unknown)
    above = None
    if request.teeth is not None and request.limit is not None:
        with clock.stage("sidebands"):
            drawn = request.teeth.drawn(sampling.samples, sampling.seed, after=deviation.shape[1])
            solved_deviation = deviation[: sampling.solved]
            made = MadePairs(study.evaluator, names, solved_deviation, request.teeth.gear, drawn)
            seed, confidence = sampling.seed, sampling.confidence
            above = sidebands_above(request.limit, made, nominal, request.teeth, seed, confidence, run)
    elif request.limit is not None:
        with clock.stage("model"):
            period = design.evaluation.ste.shape[1] // nominal.position.size
            distributions = tolerances.distributions
            pairs = DrawnPairs(
                names, deviation, ste, unknown.start, model, distributions, period, sampling.seed
            )
            above = mesh_order_above(request.limit, pairs, design.evaluation.ste[0], sampling.confidence)
    with clock.stage("confirmation"):
        of_table = Run(cache=run.cache).reporting(partial(run.progress, "confirmation"))
        table = full_table(nominal, {}, study.decision, of_table)
        error = ripple_errors(table, nominal)[0]
    run.progress("confirmation", 1.0)
    return ToleranceStudy(
        torque=study.torque,
        names=names,
        deviation=deviation,
        peak_to_peak=ripple,
        nominal=design.evaluation.peak_to_peak[0],
        error=error,
        quantiles=tuple(
            estimated_quantile(ripple, fraction, sampling.confidence) for fraction in sampling.fractions
        ),
        first_order=at_once,
        confidence=sampling.confidence,
        cost=clock.to_json(),
        request=_request_json(request),
        solved=sampling.solved,
        held=len(model_error),
        missed=np.sqrt(np.mean(model_error**2, axis=0)),
        missed_largest=np.abs(model_error).max(axis=0),
        above=above,
    )


def _request_json(request: ToleranceRequest) -> Json:
    sampling = request.sampling
    return {
        "tolerances": request.tolerances.to_json(),
        "seed": sampling.seed,
        "positions": sampling.positions,
        "misalignment_m": request.misalignment,
    }


def tangents_about(
    evaluator: Evaluator, names: tuple[str, ...], deviation: FloatArray, ste: FloatArray, by: FloatArray
) -> TangentModel:
    """Return the tangents about pairs that deviate by (n, d), from curves `ste` and their derivatives `by`.

    A deviation reduces the material that a modification removes to zero at most.
    """
    pair = evaluator.contact.pair
    designed = [0.0 if name == MISALIGNMENT else figure(pair, name) for name in names]
    minimum = np.array([least_deviation(*item) for item in zip(designed, names, strict=True)])
    return TangentModel.of(minimum, deviation, ste, by)


def _ripple(
    model: TangentModel, deviation: FloatArray, ste: FloatArray, unknown: slice
) -> tuple[FloatArray, FloatArray]:
    """Return the peak-to-peak of all pairs (N, L), and the error of the model in the `unknown` pairs, m.

    Solved pairs come first. Tangents lie above the STE, the more so the further a pair is from them. So the
    mean and the spread of the model are scaled to those of the solved pairs `unknown` to it.
    """
    solved = np.ptp(ste, axis=1)
    known, predicted = solved[unknown], model.peak_to_peak(deviation[unknown])
    further = deviation[len(solved) :]
    ripple = solved
    if len(further):
        ripple = np.concatenate([solved, as_spread(model.peak_to_peak(further), predicted, known)])
    return ripple, as_spread(predicted, predicted, known) - known


def _solved(
    evaluator: Evaluator, names: tuple[str, ...], deviation: FloatArray, sampling: Sampling, run: Run
) -> tuple[FloatArray, TangentModel]:
    """Solve pairs that deviate by (n, d); return their STE (n, P, L) in m, and tangents about the first."""
    count_of_tangents = sampling.tangents
    # whether derivatives are requested, and the deviations
    parts = ((True, deviation[:count_of_tangents]), (False, deviation[count_of_tangents:]))
    tasks = [(by, part[k : k + IN_A_TASK]) for by, part in parts for k in range(0, len(part), IN_A_TASK)]
    ste, slopes = [], []
    for count, (values, by) in enumerate(run.workers.run(curves_of_samples, (evaluator, names), tasks)):
        ste.append(values)
        slopes += [] if by is None else [by]
        run.progress("samples", (count + 1) / len(tasks))
    curves: FloatArray = np.concatenate(ste)
    if not np.isfinite(curves).all():
        bad = int((~np.isfinite(curves)).any(axis=(1, 2)).sum())
        raise SolveError(f"the contact of {bad} of {len(curves)} pairs cannot be solved", curves)
    first = slice(0, count_of_tangents)
    return curves, tangents_about(evaluator, names, deviation[first], curves[first], np.concatenate(slopes))


def curves_of_samples(
    shared: tuple[Evaluator, tuple[str, ...]], task: tuple[bool, FloatArray]
) -> tuple[FloatArray, FloatArray | None]:
    """Return the STE (n, P, L) in m of the samples (n, d) of one task, and its derivatives if requested."""
    (evaluator, names), (differentiate, deviation) = shared, task
    weight = np.full(deviation.shape[0], 1.0 / deviation.shape[0])
    pairs = replace(evaluator, nodes=ScatterNodes(names, deviation, weight))
    if not differentiate:
        return pairs.evaluate({}).ste, None
    design = linearized(pairs, {}, names, NO_LIMITS)
    return design.evaluation.ste, design.curves
