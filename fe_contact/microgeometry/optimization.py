"""Request and result of an optimization of the microgeometry.

A *figure* is a quantity of the flanks, such as a crowning; a design variable is a figure that the search
varies. *Scatter* is the distribution of misalignment and figures about a design. The design torques count
for the objective; Harris maps show T torques, the L design torques and further ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Protocol

import numpy as np

from bounds import engineering
from bounds.brief import brief
from fe_contact.analysis.request.request import Checked
from fe_contact.errors import increasing
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.confirmation import ConfirmedDesign, rising
from fe_contact.microgeometry.design_loads import DesignLoads, Misalignments
from fe_contact.microgeometry.design_problem import SLACK
from fe_contact.microgeometry.design_study import DesignSpace, DesignStudy
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, Objective, WeightedMean
from fe_contact.microgeometry.scatter import NO_SCATTER, Scatter, ScatterNodes
from fe_contact.microgeometry.search import Search, SearchRun
from fe_contact.microgeometry.variables import LENGTHS, DesignVariable, check_variables, figure
from fe_contact.options import AnalysisOptions, Levels
from fe_contact.types import Estimate, FloatArray, IntArray, Json
from model_studies import in_unit
from model_studies.record import under_key
from model_studies.result_record import ResultRecord

MAP_PARTS = np.arange(1, 11) / 8.0
"""Further torques of the Harris map over the largest design torque: up to 1.25."""
CLOSE = 0.03
"""Least distance of a further torque from a design torque, over the largest; nearer ones are left out."""


@dataclass(frozen=True)
class OptimizationRequest:
    """A pair, its design variables, and the assessment of its designs."""

    pair: ParallelAxes
    """Gear pair. Its modifications are the start of the search; those that are no variables do not change."""
    torques: Levels
    """Design torques, N m on the driving gear, increasing; equal ones only at different misalignments."""
    variables: tuple[DesignVariable, ...]
    scatter: Scatter = NO_SCATTER
    """Scatter of misalignment and modifications about the design."""
    misalignment: Misalignments = 0.0
    """Mean misalignment, m: one value, or one for each torque. Further torques of the maps interpolate it
    linearly, and take the nearest value beyond the lowest and the highest design torque.
    """
    objective: Objective = WeightedMean()  # noqa: RUF009 (frozen)
    """Objective: `WeightedMean` or `Worst` of the expectations at the torques."""
    limits: Limits = NO_LIMITS
    """Limits of pressure, face load factor, load on tip edges and root stress."""
    search: Search = Search()  # noqa: RUF009 (frozen)
    """Method, seed, starts, evaluations and positions of the search."""
    options: AnalysisOptions = AnalysisOptions()  # noqa: RUF009 (frozen)
    """Options of the analysis; `positions`, `receipt` and `on_violation` are ignored. Effects are decided
    once, for the design with every variable at the middle of its bounds and the scattered misalignment, and
    for the design with the least removed: all designs are assessed by one model.
    """
    grid: Mapping[str, FloatArray] = field(default_factory=dict)
    """Values that a drawing may state, m, increasing, by the name of the variable; a variable without is
    free."""
    map_torques: Levels | None = None
    """Further torques of the Harris maps, N m; default: up to 1.25 times the largest design torque."""

    @property
    def start_design(self) -> tuple[float, ...]:
        """Values of the variables in the pair, m, in their order; they may lie outside their bounds."""
        return tuple(figure(self.pair, variable.name) for variable in self.variables)

    @property
    def space(self) -> DesignSpace:
        """All designs of the request. Effects are decided for a design in which every variable acts."""
        acting = {variable.name: variable.acting for variable in self.variables}
        minimum = {variable.name: variable.low for variable in self.variables}
        return DesignSpace(
            self.pair,
            acting,
            self.scatter,
            self.misalignment,
            self.search.positions,
            self.options,
            minimum,
        )

    @property
    def outside(self) -> tuple[str, ...]:
        """Names of the variables that start beyond their bounds, without the lengths of missing reliefs."""
        starts = zip(self.variables, self.start_design, strict=True)
        return tuple(
            v.name
            for v, value in starts
            if not v.low <= value <= v.high and not (v.quantity in LENGTHS and value == 0.0)
        )

    @property
    def further_torques(self) -> FloatArray:
        """Torques that only the maps show, N m."""
        if self.map_torques is not None:
            return increasing("map_torques", self.map_torques)
        counted = np.asarray(self.torques, dtype=float)
        parts = MAP_PARTS * counted[-1]
        return np.asarray(parts[np.abs(parts[:, None] - counted).min(axis=1) > CLOSE * counted[-1]])

    @cached_property
    def checked(self) -> Checked:
        """The checked request over all its torques; nothing is computed yet.

        Raises the `InputError` of `optimize`.
        """
        check_variables(self.pair, self.variables)
        self.objective.check(DesignLoads.of(self.torques, self.misalignment).torque.size)
        return self.space.check(self.torques, self.further_torques)

    def to_json(self, study: DesignStudy) -> Json:
        """Return plain JSON, with what the study decided."""
        return {
            "scatter": self.scatter.to_json(),
            "objective": self.objective.to_json(),
            "limits": self.limits.to_json(),
            "search": self.search.to_json(),
            "level": study.decision.mesh.level,
            "effects": study.decision.checked.decision,
        }


class Outcome(StrEnum):
    """The outcome of an optimization."""

    IMPROVED = "improved"  # by more than the errors of both designs
    WITHIN_ERROR = "within_error"  # lower, but no more than the errors
    NOT_IMPROVED = "not_improved"  # the full analysis does not find it lower
    LIMITS_MET = "limits_kept"  # no lower beyond the errors, but the start exceeds the limits
    LIMITS_EXCEEDED = "limits_exceeded"  # no design was found that keeps the limits


class _Confirmed(Protocol):
    """A design with its errors."""

    @property
    def objective(self) -> Estimate: ...
    @property
    def violation(self) -> float: ...


def gain_of(start: _Confirmed, optimum: _Confirmed) -> Estimate:
    """Return the reduction of the objective; the errors are added, although both designs have one mesh."""
    before, after = start.objective, optimum.objective
    return Estimate(before.value - after.value, before.error + after.error, before.unit)


def level_gain(before: Estimate, after: Estimate) -> Estimate:
    """Return the fall of the level of an amplitude, dB; both relative errors are added."""
    decibels = 20.0 / math.log(10.0)
    smallest = np.finfo(float).tiny
    sizes = [max(one.value, smallest) for one in (before, after)]
    error = sum(one.error / size for one, size in zip((before, after), sizes, strict=True))
    return Estimate(decibels * math.log(sizes[0] / sizes[1]), decibels * error, "dB")


def outcome_of(start: _Confirmed, optimum: _Confirmed) -> Outcome:
    """Return the outcome of a search; a gain within its error is no improvement."""
    gain = gain_of(start, optimum)
    if optimum.violation > SLACK:
        return Outcome.LIMITS_EXCEEDED
    if gain.value > gain.error:
        return Outcome.IMPROVED
    if start.violation > SLACK:
        return Outcome.LIMITS_MET
    return Outcome.WITHIN_ERROR if gain.value > 0.0 else Outcome.NOT_IMPROVED


def excess(optimum: _Confirmed) -> str:
    """Return by how much a design exceeds the limits, in words."""
    return f"{engineering(100.0 * optimum.violation, 2)} % of them, or of the load on tip edges"


@dataclass(frozen=True)
class Perturbation:
    """The change by a small step of one variable from the optimum."""

    name: str
    low: float = field(metadata=in_unit("m"))
    high: float = field(metadata=in_unit("m"))
    """`low`, `high`: Values of the variable on both sides, m: a standard deviation away where it scatters,
    else a twentieth of its range, kept within its bounds.
    """
    change_low: float = field(metadata=in_unit("m"))
    change_high: float = field(metadata=in_unit("m"))
    """`change_low`, `change_high`: Changes of the objective at these values, m."""


@brief
@dataclass(frozen=True)
class Optimization(ResultRecord):
    """Result of `optimize`."""

    outcome: Outcome
    reason: str
    """Reason of the outcome: how the search ended, in words."""
    variables: tuple[DesignVariable, ...]
    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    """Design torques, N m. Shape (L,)."""
    misalignment: FloatArray = field(metadata=in_unit("m", "torque"))
    """Mean misalignment at each torque, m. Shape (L,)."""
    nodes: ScatterNodes
    start: ConfirmedDesign
    optimum: ConfirmedDesign
    runs: tuple[SearchRun, ...]
    """Runs of the search: one for each start, and one more for each time the best design had to be brought
    back within the limits. `best_run` is the index of the decisive one.
    """
    best_run: int
    sensitivity: tuple[Perturbation, ...]
    not_tried: tuple[str, ...]
    """Quantities that the search did not vary, in words."""
    cost: Json
    """Evaluations and CPU seconds by stage; those of the search add all its processes."""
    request: Json = field(metadata=under_key("asked"))
    """Request in SI units."""

    def __post_init__(self) -> None:
        # files of version 0.2 hold one value for all torques
        object.__setattr__(self, "misalignment", np.broadcast_to(self.misalignment, self.torque.shape))

    @property
    def gain(self) -> Estimate:
        """Reduction of the objective, m; the errors are added, although both designs have one mesh."""
        return gain_of(self.start, self.optimum)

    @property
    def rising(self) -> IntArray:
        """Indices of the torques of the Harris maps at which the optimum ripples more, beyond both errors."""
        return rising(self.start.harris_map, self.optimum.harris_map)

    @property
    def map_misalignment(self) -> FloatArray:
        """Misalignments of the torques of the Harris maps (T,), m: see `OptimizationRequest`."""
        loads, _ = DesignLoads(self.torque, self.misalignment).with_torques(self.start.harris_map.torque)
        return loads.misalignment

    @property
    def evaluations(self) -> int:
        """Designs that the search evaluated."""
        return sum(run.evaluations for run in self.runs)
