"""Analyze a design anew as `analyze` would, with the errors of its curves, at every node of the scatter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache as cached
from pathlib import Path

import numpy as np

from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.request.decided import Decided
from fe_contact.analysis.request.request_check import check_asked
from fe_contact.microgeometry.design_loads import misalignment_axis, on_axis
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.evaluator import Evaluation, Evaluator
from fe_contact.microgeometry.harris_map import HarrisMap
from fe_contact.microgeometry.scatter import ONE_NODE
from fe_contact.microgeometry.variables import modified
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate, FloatArray, Json
from model_studies import NOT_STORED, in_unit


@dataclass(frozen=True)
class ConfirmedDesign:
    """A design as analyzed in full.

    Attributes
    ----------
    values : dict of str to float
        ``gear.quantity`` to m.
    harris_map : HarrisMap
    figures : Evaluation
        Pressures, factors and curves at the nodes and the torques that count.
    objective : Estimate
        Its error adds that of the analysis and that of the scatter's rule.
    scatter_error : float
        The latter, m.
    violation : float
        Of the limits, in parts of them.
    table : SteDatabase, optional
        Over torques and misalignments, without scatter of the modifications; of a stored design None.
    """

    values: dict[str, float]
    harris_map: HarrisMap
    figures: Evaluation
    objective: Estimate
    scatter_error: float = field(metadata=in_unit("m"))
    violation: float
    table: SteDatabase | None = field(default=None, metadata=NOT_STORED)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "values_m": self.values,
            "objective_m": self.objective.value,
            "objective_error_m": self.objective.error,
            "scatter_error_m": self.scatter_error,
            "violation": self.violation,
            "peak_to_peak_m": self.figures.peak_to_peak.tolist(),
            "max_pressure_pa": self.figures.pressure.max(axis=0).tolist(),
            "face_load_factor": self.figures.face_load_factor.max(axis=0).tolist(),
            "edge_load_share": self.figures.edge_load_share.max(axis=0).tolist(),
            "harris_map": self.harris_map.to_json(),
        }


def confirm(
    problem: DesignProblem, values: Mapping[str, float], study: DesignStudy, cache: Path | None
) -> ConfirmedDesign:
    """Analyze a design in full, over all torques of a study.

    Parameters
    ----------
    problem : DesignProblem
    values : mapping
        ``gear.quantity`` to m.
    study : DesignStudy
    cache : Path, optional
        Directory of flank compliances.
    """
    search, nodes, counted = problem.evaluator, problem.evaluator.nodes, study.counted
    table = full_table(search, values, study.decided, cache)
    fine = replace(search.at(table.position), load=study.force, misalignment=study.loads.misalignment)
    figures, exact = fine.evaluate(values), replace(fine, nodes=ONE_NODE)
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
    counted_figures = Evaluation(
        figures.ste[:, :, counted],
        *(each[:, counted] for each in (figures.pressure, figures.face_load_factor, figures.edge_load_share)),
    )
    rule = _scatter_error(problem, values)
    own = problem.objective.of(harris.expected_error[counted])
    objective = Estimate(problem.objective.of(harris.expected[counted]), own + rule, "m")
    violation = counted_figures.violation(problem.limits)
    return ConfirmedDesign(dict(values), harris, counted_figures, objective, rule, violation, table)


def full_table(
    search: Evaluator, values: Mapping[str, float], decided: Decided, cache: Path | None
) -> SteDatabase:
    """Compute the table of a design over torques and the misalignments of all nodes and of none."""
    request = decided.checked.request
    skews = misalignment_axis(search.misalignment, search.nodes.misalignment)
    full = replace(
        request,
        pair=modified(request.pair, values),
        misalignment=skews,
        options=replace(request.options.at_level(decided.mesh.level), effects=dict(search.choices)),
    )
    checked = check_asked(full, spare=False)
    table = compute_database(checked, full.to_json(), Run(cache=cache), replace(decided, checked=checked))
    table.require_complete()
    return table


def ripple_errors(table: SteDatabase, fine: Evaluator) -> FloatArray:
    """Return errors of peak-to-peak (S, T), m: those of the table at the nodes and loads of an evaluator."""

    @cached
    def error(load: float, skew: float) -> float:
        return table.peak_to_peak(force=load, misalignment=skew).error

    rows = on_axis(table.misalignment, fine.misalignments).tolist()
    return np.array([[error(*point) for point in zip(fine.load.tolist(), row, strict=True)] for row in rows])


def _scatter_error(problem: DesignProblem, values: Mapping[str, float]) -> float:
    """Return by how much a finer rule for the scatter changes the objective, m."""
    search = problem.evaluator
    finer = search.nodes.finer
    if finer is None:
        return 0.0
    other = replace(search, nodes=finer)
    value, refined = (problem.objective.of(each.expected(each.evaluate(values))) for each in (search, other))
    return abs(refined - value)
