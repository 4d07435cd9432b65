"""The plan and the cost of a run, predicted without meshing or solving anything."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from bounds import engineering
from fe_contact.analysis.checks.effect_ledger import effect_ledger
from fe_contact.analysis.request.expected_curves import expected_curves
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.errors import positive
from fe_contact.geometry import ParallelAxes
from fe_contact.options import LEVELS, MESHES, AnalysisOptions, TableAxes
from fe_contact.planning.cost_model import Prediction, contact_seconds, predict_run, unit_work
from fe_contact.planning.cost_of_derivatives import ContactWork
from fe_contact.planning.expected_curves import ExpectedCurves
from fe_contact.planning.expected_error import ExpectedError, expected_error
from fe_contact.planning.plan import Plan
from fe_contact.planning.planned import MeshChoice
from fe_contact.types import Json
from model_studies.host_speed import host_slowness

_DESIGN_WORK = 0.75
"""Cost of the contact solution of one design, at equally spaced positions, over that of a table with adaptive
positions. Sweeps of two gear pairs gave 0.55 to 1.0.
"""


@dataclass(frozen=True)
class PlannedLevel:
    """A mesh level with its slices: its predicted cost, and its expected error."""

    model: str
    level: str
    slices: int
    cost: Prediction
    error: ExpectedError

    def to_json(self) -> Json:
        """Return plain JSON."""
        return vars(self) | {"cost": self.cost.to_json(), "error": self.error.to_json()}


@dataclass(frozen=True)
class RunPlan:
    """The plan of a run."""

    checked: Checked
    """The request with its model and its ledger of effects."""
    choice: MeshChoice
    """The mesh that would be taken."""
    plan: Plan
    passes: tuple[PlannedLevel, ...]
    """Predictions by pass: for the mesh that would be taken, and where that is a trial that may miss the
    tolerance, for the mesh that is expected to follow it.
    """
    levels: tuple[PlannedLevel, ...]
    """Predictions for the chosen mesh and the other mesh levels of the same model. Where the time does not
    allow the mesh that the tolerance needs, its prediction is here too.
    """
    conflict: str
    """Reason why tolerance and time budget cannot both be met; empty if they can, or if one was not given."""
    cache: Path | None = None
    """Cache directory that the prediction assumes."""

    @property
    def chosen(self) -> PlannedLevel:
        """The prediction for the mesh that would be taken."""
        return self.passes[0]

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "choice": {"model": self.checked.model_name} | self.choice.to_json(),
            "prediction": self.chosen.cost.to_json(),
            "error": self.chosen.error.to_json(),
            "levels": [entry.to_json() for entry in self.levels],
            "passes": [entry.to_json() for entry in self.passes],
            "conflict": self.conflict,
            "plan": self.plan.to_json(),
            "warnings": [finding.to_json() for finding in self.checked.request.findings],
            "effect_ledger": effect_ledger(self.checked, self.cache, plan=self.plan),
        }


def plan_run(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    time_budget: float | None = None,
    cache: Path | None = None,
) -> RunPlan:
    """Predict time by stage, memory and error of `analyze`, and list its effects.

    Raises `InputError`: a value cannot be used; it names the field.

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        A request that is checked already stands for pair, axes and options.
    time_budget : float, optional
        CPU seconds; replaces the time budget of the options. With a level in the options, the plan says
        whether the level fits the time.
    cache : Path, optional
        Directory of flank compliances; a compliance that it holds costs nothing.
    """
    checked = as_checked(pair, axes, options)
    options = checked.request.options
    budget = options.time_budget if time_budget is None else time_budget
    if options.level is None:  # a level and a budget exclude each other in options
        options = replace(options, time_budget=budget)
        checked = replace(checked, request=replace(checked.request, options=options))
    decision = decide(checked, cache, tried=True)
    checked, choice = decision.checked, decision.mesh
    curves = expected_curves(checked)
    others = [_planned_level(checked, name, curves, cache) for name in LEVELS if name != choice.level]
    needed = () if decision.wished is None else (_decision(decision.wished, curves, cache),)
    passes = tuple(_decision(later, curves, cache) for later in decision.passes)
    # the same mesh may be in several groups; the last prediction is kept
    by_mesh = {(entry.model, entry.level, entry.slices): entry for entry in (*others, *needed, *passes)}
    levels = sorted(by_mesh.values(), key=lambda entry: MESHES.index(entry.level))
    conflict = ""
    if budget is not None and (options.tolerance is not None or options.level is not None):
        conflict = _conflict(decision, positive("time_budget", budget, "Seconds."), cache)
    return RunPlan(checked, choice, decision.plan, passes, tuple(levels), conflict, cache)


class PredictedDesigns(NamedTuple):
    """CPU seconds of other flanks, loads and alignments on the same gears."""

    bodies: float
    """CPU seconds to condense both gears."""
    coarse_bodies: float
    """CPU seconds to condense both gears on coarse meshes: solutions on them yield the error of the mesh."""
    design: float
    """CPU seconds of one pair of flanks at one alignment, all loads at once."""
    errors: float
    """CPU seconds of the solutions that measure the errors of one design."""
    positions: int
    """Number of positions of one design."""
    across_face: bool
    """Whether the gears are condensed in three dimensions."""
    bytes: float
    """Largest resident memory of the process, bytes."""
    work: ContactWork
    """Work of the contact solution of one design, by kind."""

    @property
    def all_bodies(self) -> float:
        """CPU seconds to condense both gears, coarse meshes included."""
        return self.bodies + self.coarse_bodies


def predicted_designs(checked: Checked, cache: Path | None) -> PredictedDesigns:
    """Predict the cost of solutions on condensed gears; nothing is meshed.

    Parameters
    ----------
    checked : Checked
        The request whose loads every design is solved at.
    cache : Path, optional
        Directory of flank compliances; a compliance that it holds costs nothing.
    """
    choice = decide(checked, cache)
    pair, model = choice.checked.request.pair, choice.checked.model
    one_alignment = 1, 1  # numbers of misalignments and of center distances
    prediction = predict_run(pair, choice.plan, model, one_alignment, cache)
    parts = prediction.parts
    errors = parts["error estimate"]["solutions"]
    slowness = host_slowness(cache)
    unit = unit_work(pair, choice.plan, choice.plan.discretization.slices)
    return PredictedDesigns(
        bodies=parts["compliance"]["bodies"],
        coarse_bodies=parts["error estimate"]["bodies"],
        design=_DESIGN_WORK * parts["contact"]["table"],
        errors=errors,
        positions=prediction.positions,
        across_face=model.across_face,
        bytes=float(prediction.memory_bytes),
        work=ContactWork(*(slowness * work_of_part for work_of_part in unit)),
    )


def table_seconds(
    checked: Checked, pair: ParallelAxes, alignments: tuple[int, int], cache: Path | None
) -> float:
    """Return the CPU seconds of a whole table of one design on condensed gears, its errors included.

    It costs more where flanks vary along the profile: the compliance changes with the touching points.

    Parameters
    ----------
    checked : Checked
        The request of all designs, whose model and mesh the table has.
    pair : GearPair or InternalGearPair
        The pair with the flanks of the design.
    alignments : (int, int)
        Numbers of misalignments and of center distances.
    """
    choice = decide(checked, cache)
    search, solve, check = contact_seconds(pair, choice.plan, choice.checked.model, alignments)
    correction = choice.predicted(cache).correction
    seconds = correction["contact"] * (search + solve) + correction["error estimate"] * check
    return host_slowness(cache) * seconds


def _decision(choice: Decision, curves: ExpectedCurves | None, cache: Path | None) -> PlannedLevel:
    """Predict cost and error of a decision.

    Where the decision was made by an expected error in m, that error is returned; else it is computed here.
    """
    checked, option, request = choice.checked, choice.mesh.option, choice.checked.request
    error = option.error
    if not error.mean:  # None or 0: no size of the transmission error was known to the decision
        error = expected_error(request.pair, choice.plan, curves, model_chosen=request.model_chosen)
    return PlannedLevel(checked.model_name, option.level, option.slices, choice.predicted(cache), error)


def _planned_level(
    checked: Checked, level: str, curves: ExpectedCurves | None, cache: Path | None
) -> PlannedLevel:
    options = replace(checked.request.options, level=None)
    plan = replace(checked, request=replace(checked.request, options=options)).plan(level)
    cost, request = checked.predicted(plan, cache), checked.request
    error = expected_error(request.pair, plan, curves, model_chosen=request.model_chosen)
    return PlannedLevel(checked.model_name, level, plan.discretization.slices, cost, error)


def _conflict(choice: Decision, time_budget: float, cache: Path | None) -> str:
    tolerance = choice.checked.request.options.tolerance
    goal = f"level {choice.mesh.level}" if tolerance is None else tolerance.text
    refusal = f"{goal} within {time_budget:.3g} CPU s cannot be had"
    if not choice.mesh.met:
        return f"{refusal}: {choice.mesh.reason}"
    seconds = choice.predicted(cache).cpu_seconds
    return f"{refusal}: it needs {engineering(seconds, 2)} CPU s" if seconds > time_budget else ""
