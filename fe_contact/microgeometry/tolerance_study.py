"""Tolerance Monte Carlo: how peak-to-peak STE is distributed over pairs as they are made and assembled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.special import ndtr, ndtri

from bounds import SiNote
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import InputError, SolveError, integer, positive, within
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.geometry.flank_tolerances import check_scope, helix_slope_tolerance, profile_slope_tolerance
from fe_contact.microgeometry.confirmation import DesignSpace, design_study, full_table, ripple_errors
from fe_contact.microgeometry.evaluator import Evaluator, least_deviation
from fe_contact.microgeometry.linearized_design import linearized
from fe_contact.microgeometry.objective import NO_LIMITS
from fe_contact.microgeometry.scatter import MISALIGNMENT, ONE_NODE, Scatter, ScatterNodes, SobolSample
from fe_contact.microgeometry.variables import GEARS, figure, gear_and_quantity
from fe_contact.options import AnalysisOptions, Levels, Run
from fe_contact.types import FloatArray, Json
from model_studies import in_unit
from model_studies.spread import quantile_bounds, rank_correlation
from model_studies.stage_clock import StageClock

# Tolerances of assembly and manufacture: how figures are distributed between the limits of inspection.


Distribution = Literal["normal", "uniform"]
PROCESS_SPREAD = 3.0
"""Standard deviations of the normal distribution in a tolerance, beyond which parts are rejected."""


@dataclass(frozen=True)
class Tolerances:
    """Half widths of tolerance bands about the design, and the distribution within them.

    Attributes
    ----------
    misalignment : float
        m, >= 0.
    modification : mapping
        ``gear.quantity`` to m, > 0.
    distribution : {"normal", "uniform"}
        Normal: three standard deviations are the tolerance, and deviations beyond are rejected.
    """

    misalignment: float = 0.0
    modification: Mapping[str, float] = field(default_factory=dict)
    distribution: Distribution = "normal"

    def __post_init__(self) -> None:
        if self.misalignment:
            positive("tolerances.misalignment", self.misalignment, SiNote("In m: 10 µm is 1e-5."))
        for name, width in self.modification.items():
            gear_and_quantity(f"tolerances.modification.{name}", name)
            positive(f"tolerances.modification.{name}", width, SiNote("In m: 10 µm is 1e-5."))
        if self.distribution not in ("normal", "uniform"):
            raise InputError("tolerances.distribution", self.distribution, 'one of "normal" and "uniform"')
        if not self.widths:
            raise InputError("tolerances", {}, "at least one width above 0")

    @property
    def widths(self) -> dict[str, float]:
        """Half width of every deviation, m, in a fixed order."""
        own = {MISALIGNMENT: self.misalignment} if self.misalignment else {}
        return own | dict(sorted(self.modification.items()))

    def sample(self, count: int, seed: int) -> FloatArray:
        """Draw deviations (count, d) in m; a larger sample of the same seed begins with a smaller one."""
        widths = np.array(list(self.widths.values()))
        uniform = np.random.Generator(np.random.PCG64(seed)).random((count, widths.size))
        if self.distribution == "uniform":
            return np.asarray(widths * (2.0 * uniform - 1.0))
        low = ndtr(-PROCESS_SPREAD)
        return np.asarray(widths * ndtri(low + (1.0 - 2.0 * low) * uniform) / PROCESS_SPREAD)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "misalignment_m": self.misalignment,
            "modification_m": dict(self.modification),
            "distribution": self.distribution,
        }


def iso1328_tolerances(
    pair: ParallelAxes,
    tolerance_class: int,
    *,
    misalignment: float = 0.0,
    across_face: bool = True,
    distribution: Distribution = "normal",
) -> Tolerances:
    """Return tolerances of profile and helix slope of both gears by ISO 1328-1:2013.

    Raises `InputError`: no such class, or a gear beyond the range of the standard.

    Parameters
    ----------
    tolerance_class : int
        1 (finest) to 11.
    misalignment : float
        Of the assembly, m; the standard has none.
    across_face : bool
        Whether helix slopes deviate too; a plane model cannot have it.
    """
    integer("tolerance_class", tolerance_class, 1, 11)
    widths = {}
    for name in GEARS:
        gear: Toothing = getattr(pair, name)
        check_scope(name, gear)
        widths[f"{name}.profile_slope"] = profile_slope_tolerance(gear, tolerance_class)
        if across_face:
            widths[f"{name}.helix_slope"] = helix_slope_tolerance(gear, tolerance_class)
    return Tolerances(misalignment, widths, distribution)


# Quantiles of a sample with confidence bounds that assume no shape of the distribution.


@dataclass(frozen=True)
class Quantile:
    """A quantile of peak-to-peak at each of L torques.

    Attributes
    ----------
    fraction : float
        Part of all pairs that lie below.
    value, low, high : ndarray, shape (L,)
        Estimate and confidence bounds, m; infinite or zero where the sample is too small for a bound.
    """

    fraction: float
    value: FloatArray = field(metadata=in_unit("m", "torque"))
    low: FloatArray = field(metadata=in_unit("m", "torque"))
    high: FloatArray = field(metadata=in_unit("m", "torque"))


def _quantile(sample: FloatArray, fraction: float, confidence: float) -> Quantile:
    """Estimate a quantile of samples (N, L) of lengths with distribution-free bounds."""
    value, low, high = quantile_bounds(sample, fraction, confidence)
    return Quantile(fraction, value, np.maximum(low, 0.0), high)


# Sampling of a tolerance Monte Carlo: the pairs it draws and the quantities it estimates.


@dataclass(frozen=True)
class Sampling:
    """A sample of pairs and its quantiles.

    Attributes
    ----------
    samples : int
        Pairs, 2 to 1 000 000.
    seed : int
        Equal seeds give equal results to the last bit, with any workers.
    confidence : float
        Of the bounds of the quantiles.
    fractions : sequence of float
        Quantiles to estimate.
    positions : int
        Equally spaced in a base pitch.
    """

    samples: int = 1000
    seed: int = 0
    confidence: float = 0.95
    fractions: Sequence[float] = (0.05, 0.5, 0.95)
    positions: int = 64

    def __post_init__(self) -> None:
        integer("samples", self.samples, 2, 1_000_000)
        integer("seed", self.seed, 0, 2**63 - 1)
        within("confidence", self.confidence, 0.5, 0.9999)
        for index, fraction in enumerate(self.fractions):
            within(f"fractions[{index}]", fraction, 0.0, 1.0)


IN_A_TASK = 25
"""Samples of a task: half a second to some seconds. It does not depend on who does the tasks."""
ACTING = SobolSample(1)
"""Two pairs that deviate in everything: by them the effects are decided."""


@dataclass(frozen=True)
class ToleranceStudy:
    """Peak-to-peak of N pairs at L torques.

    Attributes
    ----------
    torque : ndarray, shape (L,)
        N m.
    names : tuple of str
        The deviations: "misalignment" and ``gear.quantity``.
    deviation : ndarray, shape (N, d)
        m.
    peak_to_peak : ndarray, shape (N, L)
        m.
    nominal, error : ndarray, shape (L,)
        Without deviations, and the error of the analysis there, m.
    quantiles : tuple of Quantile
    first_order : ndarray, shape (N, L)
        Peak-to-peak of the same pairs from the nominal curves and their derivatives, m.
    confidence : float
        Of the bounds of the quantiles.
    cost : dict
        CPU and wall seconds by stage, of this process.
    asked : dict
    """

    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    names: tuple[str, ...]
    deviation: FloatArray = field(metadata=in_unit("m", "sample", "deviating"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "sample", "torque"))
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    error: FloatArray = field(metadata=in_unit("m", "torque"))
    quantiles: tuple[Quantile, ...]
    first_order: FloatArray = field(metadata=in_unit("m", "sample", "torque"))
    confidence: float
    cost: Json
    asked: Json

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
) -> ToleranceStudy:
    """Sample pairs within their tolerances and compute the peak-to-peak transmission error of each.

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
    """
    return sampled(ToleranceRequest(pair, torques, tolerances, sampling, options, misalignment), run)


@dataclass(frozen=True)
class ToleranceRequest:
    """What `scatter` takes."""

    pair: ParallelAxes
    torques: Levels
    tolerances: Tolerances
    sampling: Sampling
    options: AnalysisOptions
    misalignment: float

    @property
    def space(self) -> DesignSpace:
        """The pairs that the tolerances allow, as designs: everything deviates that may."""
        deviations = Scatter(self.tolerances.misalignment, self.tolerances.modification, ACTING)
        return DesignSpace(
            self.pair, {}, deviations, self.misalignment, self.sampling.positions, self.options
        )

    @cached_property
    def checked(self) -> Checked:
        """Everything is checked, nothing computed; raises `InputError`."""
        return self.space.check(self.torques)


def sampled(request: ToleranceRequest, run: Run) -> ToleranceStudy:
    """Sample pairs within tolerances; see `scatter`."""
    clock, tolerances, sampling = StageClock(run.workers.cost), request.tolerances, request.sampling
    study = design_study(request.space, request.torques, [], clock, run, request.checked)
    deviation = tolerances.sample(sampling.samples, sampling.seed)
    names, nominal = tuple(tolerances.widths), replace(study.evaluator, nodes=ONE_NODE)
    with clock.stage("first order"):
        at_once = _first_order(nominal, names, deviation)
    with clock.stage("samples"):
        ripple = _evaluated(study.evaluator, names, deviation, run)
    with clock.stage("confirmation"):
        table = full_table(nominal, {}, study.decided, run.cache)
        error = ripple_errors(table, nominal)[0]
    run.progress("confirmation", 1.0)
    return ToleranceStudy(
        study.torque,
        names,
        deviation,
        ripple,
        nominal.evaluate({}).peak_to_peak[0],
        error,
        tuple(_quantile(ripple, fraction, sampling.confidence) for fraction in sampling.fractions),
        at_once,
        sampling.confidence,
        clock.to_json(),
        {
            "tolerances": tolerances.to_json(),
            "seed": sampling.seed,
            "positions": sampling.positions,
            "misalignment_m": request.misalignment,
        },
    )


def _evaluated(evaluator: Evaluator, names: tuple[str, ...], deviation: FloatArray, run: Run) -> FloatArray:
    tasks = [deviation[k : k + IN_A_TASK] for k in range(0, deviation.shape[0], IN_A_TASK)]
    parts = []
    for count, part in enumerate(run.workers.run(_ripple_of_samples, (evaluator, names), tasks)):
        parts.append(part)
        run.progress("samples", (count + 1) / len(tasks))
    ripple: FloatArray = np.concatenate(parts)
    if not np.isfinite(ripple).all():
        bad = int((~np.isfinite(ripple)).any(axis=1).sum())
        raise SolveError(f"the contact of {bad} of {ripple.shape[0]} pairs cannot be solved", ripple)
    return ripple


def _first_order(nominal: Evaluator, names: tuple[str, ...], deviation: FloatArray) -> FloatArray:
    """Peak-to-peak (N, L) in m of pairs that deviate by (N, d), from curves that are linear in it.

    Nothing is removed below zero by a deviation.
    """
    design = linearized(nominal, {}, names, NO_LIMITS)
    pair = nominal.contact.pair
    designed = [0.0 if name == MISALIGNMENT else figure(pair, name) for name in names]
    least = np.array([least_deviation(*each) for each in zip(designed, names, strict=True)])
    held = np.maximum(deviation, least)
    curves = (
        design.evaluation.ste[0, :, k] + held @ design.curves[0, :, k].T for k in range(nominal.load.size)
    )
    return np.stack([np.ptp(each, axis=1) for each in curves], axis=1)


def _ripple_of_samples(shared: tuple[Evaluator, tuple[str, ...]], deviation: FloatArray) -> FloatArray:
    """Peak-to-peak (n, L) in m of some samples (n, d): one task."""
    evaluator, names = shared
    weight = np.full(deviation.shape[0], 1.0 / deviation.shape[0])
    return replace(evaluator, nodes=ScatterNodes(names, deviation, weight)).evaluate({}).peak_to_peak
