"""Full analysis of a design as `analyze` does it, with errors, at every node of the scatter.

The *scatter* is the distribution of misalignment and modifications about a design. Its *nodes* are the points
of a quadrature rule over it. A *ripple* is the peak-to-peak transmission error at one load. Loads *counted*
are the design torques, of which the objective is made; further torques are for the Harris map alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache as cached
from pathlib import Path

import numpy as np

from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.request.model_choice import Decision
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.microgeometry.confirmed_figures import confirmed_figures
from fe_contact.microgeometry.design_loads import misalignment_axis, snapped_to_axis
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.evaluator import Evaluation, Evaluator
from fe_contact.microgeometry.scatter import ONE_NODE
from fe_contact.microgeometry.variables import modified
from fe_contact.options import Run
from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import Estimate, FloatArray, IntArray
from model_studies import NOT_STORED, in_unit
from model_studies.progress import Report, unreported

TABLE_SHARE = 0.6
"""Usual share of the table in the cost of an analysis: 0.3 in the plane to 0.7 over the face."""


@dataclass(frozen=True)
class HarrisMap:
    """Curves of one design at T torques, and their ripple at S nodes of the scatter."""

    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    """Torque on the driving gear, N m, increasing. Shape (T,)."""
    position: FloatArray
    """Position, base pitches. Shape (P,)."""
    ste: FloatArray = field(metadata=in_unit("m", "position", "torque"))
    """Transmission error without scatter, m. Shape (P, T)."""
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    nominal_error: FloatArray = field(metadata=in_unit("m", "torque"))
    """`nominal`, `nominal_error`: Peak-to-peak STE without scatter and its error, m. Shape (T,) each."""
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "node", "torque"))
    error: FloatArray = field(metadata=in_unit("m", "node", "torque"))
    """`peak_to_peak`, `error`: Peak-to-peak STE at the nodes and its error, m. The error is that of the table
    at the node's misalignment: deviations of the modification change the ripple, not the discretization.
    Shape (S, T) each.
    """
    weight: FloatArray
    """Weights of the nodes. Shape (S,)."""

    @property
    def expected(self) -> FloatArray:
        """Expectation of peak-to-peak STE over the scatter (T,), m."""
        return np.asarray(self.weight @ self.peak_to_peak)

    @property
    def expected_error(self) -> FloatArray:
        """Error of `expected` (T,), m. Errors of the nodes may all have the same sign."""
        return np.asarray(self.weight @ self.error)


@dataclass(frozen=True)
class ConfirmedDesign:
    """A design as analyzed in full."""

    values: dict[str, float]
    """Values of the design variables, ``gear.quantity`` to m."""
    harris_map: HarrisMap
    """Curves and ripples at all torques, counted or not."""
    figures: Evaluation
    """Pressures, factors and curves at the nodes and the design torques."""
    objective: Estimate
    """Objective of the design. Its error is the sum of those of the analysis and of the quadrature."""
    scatter_error: float = field(metadata=in_unit("m"))
    """Error of the objective by the quadrature over the scatter, m."""
    violation: float
    """Largest excess over a limit, relative to the limit."""
    table: SteDatabase | None = field(default=None, metadata=NOT_STORED)
    """Table over torques and misalignments, without scatter of the modifications; None for a stored design.
    """


def confirm(
    problem: DesignProblem,
    values: Mapping[str, float],
    study: DesignStudy,
    cache: Path | None,
    report: Report = unreported,
) -> ConfirmedDesign:
    """Analyze a design in full, over all torques of a study.

    Parameters
    ----------
    values : mapping
        ``gear.quantity`` to m.
    cache : Path, optional
        Directory of flank compliances.
    report : callable
        Called with the fraction done.
    """
    search, counted = problem.evaluator, study.counted
    nodes = search.nodes
    run = Run(cache=cache).reporting(lambda fraction: report(TABLE_SHARE * fraction))
    table = full_table(search, values, study.decision, run)
    fine = replace(search.at(table.position), load=study.force, misalignment=study.loads.misalignment)
    figures = confirmed_figures(fine, values, cache)
    exact = replace(fine, nodes=ONE_NODE)  # the design without scatter
    error = ripple_errors(table, fine)
    ripple = figures.peak_to_peak
    nominal = exact.evaluate(values)
    harris = HarrisMap(
        torque=study.loads.torque,
        position=table.position,
        ste=nominal.ste[0],
        nominal=nominal.peak_to_peak[0],
        nominal_error=ripple_errors(table, exact)[0],
        peak_to_peak=ripple,
        error=error,
        weight=nodes.weight,
    )
    counted_figures = figures.at_loads(counted)
    scatter_error = _scatter_error(problem, values)
    value, map_error = _objective(problem, values, table, harris, counted)
    objective = Estimate(value, map_error + scatter_error, "m")
    violation = counted_figures.violation(problem.limits)
    report(1.0)
    return ConfirmedDesign(dict(values), harris, counted_figures, objective, scatter_error, violation, table)


def _objective(
    problem: DesignProblem,
    values: Mapping[str, float],
    table: SteDatabase,
    harris: HarrisMap,
    counted: IntArray,
) -> tuple[float, float]:
    """Return the objective of a design, and its error by the table, m.

    The positions of a search, evenly spaced, resolve a harmonic; the table has its error.
    """
    objective, search = problem.objective, problem.evaluator
    harmonic = objective.harmonic
    if harmonic is None:
        return objective.of(harris.expected[counted]), objective.of(harris.expected_error[counted])
    errors = _errors(table, search, lambda curve: curve.harmonics[harmonic - 1])
    return problem.objective_of(search.evaluate(values)), objective.of(search.nodes.weight @ errors)


def full_table(search: Evaluator, values: Mapping[str, float], decision: Decision, run: Run) -> SteDatabase:
    """Compute the table of a design over all torques, at the misalignments of all nodes and of the design."""
    request = decision.checked.request
    skews = misalignment_axis(search.misalignment, search.nodes.misalignment)
    full = replace(
        request,
        pair=modified(search.contact.pair, values),
        misalignment=skews,
        options=replace(request.options.at_level(decision.mesh.level), effects=dict(search.choices)),
    )
    checked = checked_request(full, neglect=False)
    table = compute_database(checked, full.to_json(), run, replace(decision, checked=checked))
    table.require_complete()
    return table


def ripple_errors(table: SteDatabase, fine: Evaluator) -> FloatArray:
    """Return the errors of peak-to-peak (S, T), m, of the table at the nodes and loads of an evaluator."""
    return _errors(table, fine, lambda curve: curve.peak_to_peak)


def _errors(table: SteDatabase, fine: Evaluator, figure: Callable[[Curve], Estimate]) -> FloatArray:
    """Return the errors of a figure of the curves (S, T), m, at the nodes and loads of an evaluator."""

    @cached
    def error(load: float, skew: float) -> float:
        return figure(table.curve(force=load, misalignment=skew)).error

    rows = snapped_to_axis(table.misalignment, fine.misalignments).tolist()
    return np.array([[error(*point) for point in zip(fine.load.tolist(), row, strict=True)] for row in rows])


def _scatter_error(problem: DesignProblem, values: Mapping[str, float]) -> float:
    """Return by how much a finer quadrature over the scatter changes the objective, m."""
    search = problem.evaluator
    finer = search.nodes.finer
    if finer is None:
        return 0.0
    other = replace(search, nodes=finer)
    value, refined = (
        problem.objective_of(evaluator.evaluate(values), evaluator) for evaluator in (search, other)
    )
    return abs(refined - value)


def rising(before: HarrisMap, after: HarrisMap) -> IntArray:
    """Return the indices of torques at which the expected ripple rises by more than the errors of both."""
    change = after.expected - before.expected
    return np.flatnonzero(change > before.expected_error + after.expected_error)
