"""The plan and the cost of a run, predicted without meshing or solving anything."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from bounds import engineering
from fe_contact.analysis.checks.effect_ledger import effect_ledger
from fe_contact.analysis.request.decided import Decided, model_name
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.request.ripple import expected_curves
from fe_contact.checks import positive
from fe_contact.geometry import ParallelAxes
from fe_contact.options import LEVELS, AnalysisOptions, TableAxes
from fe_contact.planning import (
    ExpectedCurves,
    ExpectedError,
    MeshChoice,
    Plan,
    Prediction,
    expected_error,
    make_plan,
    predict_run,
)
from fe_contact.types import Json


@dataclass(frozen=True)
class PlannedLevel:
    """One mesh level with its slices: what it is predicted to cost, and its expected error."""

    level: str
    slices: int
    cost: Prediction
    error: ExpectedError

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "level": self.level,
            "slices": self.slices,
            "cost": self.cost.to_json(),
            "error": self.error.to_json(),
        }


@dataclass(frozen=True)
class RunPlan:
    """The plan of a run.

    Attributes
    ----------
    checked : Checked
        The request with its model and its ledger of effects.
    choice : MeshChoice
        The mesh that would be taken.
    plan : Plan
    levels : tuple of PlannedLevel
        All mesh levels of the same model.
    conflict : str
        Why tolerance and time cannot both be had; empty if they can, or if not both were given.
    cache : Path, optional
        Of the prediction.
    """

    checked: Checked
    choice: MeshChoice
    plan: Plan
    levels: tuple[PlannedLevel, ...]
    conflict: str
    cache: Path | None = None

    @property
    def chosen(self) -> PlannedLevel:
        """The prediction for the mesh that would be taken."""
        return next(entry for entry in self.levels if entry.level == self.choice.level)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "choice": {"model": model_name(self.checked)} | self.choice.to_json(),
            "prediction": self.chosen.cost.to_json(),
            "error": self.chosen.error.to_json(),
            "levels": [entry.to_json() for entry in self.levels],
            "conflict": self.conflict,
            "plan": self.plan.to_json(),
            "warnings": [finding.to_json() for finding in self.checked.request.findings],
            "effect_ledger": effect_ledger(self.checked, self.cache, plan=self.plan),
        }


def plan_run(
    pair: ParallelAxes,
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    time_budget: float | None = None,
    cache: Path | None = None,
) -> RunPlan:
    """Predict time by stage, memory and error of `analyze`, and list its effects.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    axes : TableAxes
    options : AnalysisOptions
    time_budget : float, optional
        CPU seconds in place of that of the options. It may stand beside a level: the plan says whether the
        level fits the time.
    cache : Path, optional
        Of flank compliances: what is in it costs nothing.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    """
    budget = options.time_budget if time_budget is None else time_budget
    if options.level is None:
        options = replace(options, time_budget=budget)
    checked = check_request(pair, axes, options)
    decided = decide(checked, cache, tried=True)
    checked, choice = decided.checked, decided.mesh
    curves = expected_curves(checked)
    levels = tuple(
        _planned(checked, name, choice.slices if name == choice.level else None, curves, cache)
        for name in LEVELS
    )
    conflict = ""
    if budget is not None and (options.tolerance is not None or options.level is not None):
        conflict = _conflict(decided, positive("time_budget", budget, "Seconds."), cache)
    return RunPlan(checked, choice, decided.plan, levels, conflict, cache)


def _planned(
    checked: Checked, level: str, slices: int | None, curves: ExpectedCurves | None, cache: Path | None
) -> PlannedLevel:
    """Predict one mesh level of the request's model, in so many slices or in the usual ones.

    With the case's own curves, as its mesh is chosen by: both must tell the same error.
    """
    request = checked.request
    options = request.options.at_level(level)
    plan = make_plan(request.pair, request.load, options, checked.model, slices=slices)
    cost = predict_run(request.pair, plan, checked.model, request.alignments, cache)
    error = expected_error(request.pair, plan, curves)
    return PlannedLevel(level, plan.discretization.slices, cost, error)


def _conflict(decided: Decided, time_budget: float, cache: Path | None) -> str:
    """Say why what is requested does not fit into the time; empty if it does."""
    within = f"within {time_budget:.3g} CPU s"
    tolerance = decided.checked.request.options.tolerance
    goal = f"level {decided.mesh.level}" if tolerance is None else tolerance.words
    if not decided.mesh.met:
        return f"{goal} {within} cannot be had: {decided.mesh.reason}"
    seconds = decided.predicted(cache).cpu_seconds
    return (
        ""
        if seconds <= time_budget
        else (f"{goal} {within} cannot be had: it needs {engineering(seconds, 2)} CPU s")
    )
