"""A table as solved, before its errors are known: plan, places, positions, solutions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoints, operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.pairs.solved_operating_points import Solved, solve_operating_points
from fe_contact.analysis.pairs.tabulate import pair_facts, table_fields, table_support
from fe_contact.analysis.request.decided import Decided
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.tables.position_nodes import PositionNodes
from fe_contact.analysis.tables.table_nodes import table_nodes
from fe_contact.compliance.remote_condensation import condense_remotely, condensing
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run
from fe_contact.planning import FaceDiscretization, Plan, Prediction, predict_run
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess
from model_studies.progress import Report, by_cost, unreported


@dataclass(frozen=True)
class SolvedTable:
    """One run up to its table.

    Attributes
    ----------
    decided : Decided
        Model and discretization.
    prediction : Prediction
        What it was expected to cost.
    places : OperatingPoints
    nodes : PositionNodes
    solved, support : list of (ContactProblem, ContactSolution)
        Of every place, at the requested and at the support loads.
    table : SteDatabase
        Its errors not yet estimated.
    condition : ndarray or None
        Condition numbers of the compliances, where workers found them.
    """

    decided: Decided
    prediction: Prediction
    places: OperatingPoints
    nodes: PositionNodes
    solved: Solved
    support: Solved
    table: SteDatabase
    condition: FloatArray | None = None

    @property
    def checked(self) -> Checked:
        """The request with the model that was chosen."""
        return self.decided.checked

    @property
    def plan(self) -> Plan:
        """Discretization."""
        return self.decided.plan


def solve_table(
    checked: Checked,
    clock: StageClock,
    run: Run,
    before: SolvedTable | None = None,
    decided: Decided | None = None,
) -> SolvedTable:
    """Plan and solve a request.

    Parameters
    ----------
    checked : Checked
    clock : StageClock
    run : Run
    before : SolvedTable, optional
        The same pair with other effects: its compliance is taken if the bodies are the same.
    decided : Decided, optional
        Model and discretization; default: those that the accuracy asks for.
    """
    full = checked.request.options.receipt == "full"
    with clock.stage("planning"):
        decided = decided or decide(checked, run.cache)
        checked, plan, request = decided.checked, decided.plan, decided.checked.request
        arguments = request.pair, plan, checked.model, request.alignments
        prediction = predict_run(*arguments, run.cache, with_errors=full)
    known = before.places.nominal if before is not None and _same_bodies(before.plan, plan) else None
    run.on_plan(prediction.stages)
    report = partial(run.progress, "compliance")
    nominal = condensed_bodies(checked, plan, clock, run, known=known, report=report)
    points = operating_points(request.scene, request.choices, nominal, run.workers)
    with clock.stage("contact"):
        progress = by_cost(partial(run.progress, "contact"), prediction.parts["contact"])
        nodes = table_nodes(points, plan, partial(progress, "positions"))
        loads, report = (plan.load, plan.support), partial(progress, "table")
        (solved, support), condition = solve_operating_points(
            points, nodes.position, loads, conditioned=full, report=report
        )
        table = assembled_table(request, points, nodes, solved, support)
        run.progress("contact", 1.0)
    return SolvedTable(decided, prediction, points, nodes, solved, support, table, condition)


def condensed_bodies(
    checked: Checked,
    plan: Plan,
    clock: StageClock,
    run: Run,
    *,
    coarse: bool = False,
    known: PairContact | None = None,
    report: Report = unreported,
) -> PairContact:
    """Compute or fetch the compliances of both gears, fine or coarse, as a stage of the run."""
    request = checked.request
    report(0.0)
    with clock.stage("error estimate" if coarse else "compliance"):
        changes = request.center_distance_change
        nominal = known or _condensed(request.pair, plan, coarse, changes, run, report)
    report(1.0)
    return nominal


def _condensed(
    pair: ParallelAxes, plan: Plan, coarse: bool, changes: FloatArray, run: Run, report: Report
) -> PairContact:
    """Condense the gears, those of three dimensions by the workers if there are any."""
    made = plan.discretization
    if isinstance(condensing(run.workers), InProcess) or not isinstance(made, FaceDiscretization):
        return pair_contact(pair, plan, run.cache, coarse, changes, report)
    with TemporaryDirectory() as folder:
        kept = run.cache or Path(folder)
        recipes = made.coarse_recipes if coarse else made.recipes
        condense_remotely(plan.bodies(pair), recipes, kept, run.workers, report)
        return pair_contact(pair, plan, kept, coarse, changes)


def _same_bodies(own: Plan, other: Plan) -> bool:
    """Whether two plans of one pair have the same finite elements."""
    first, second = ((plan.discretization, plan.parts) for plan in (own, other))
    return first == second


def assembled_table(
    request: Request, points: OperatingPoints, nodes: PositionNodes, solved: Solved, support: Solved
) -> SteDatabase:
    """Assemble the table, its errors not yet estimated; `support` may be empty."""
    position = (np.arange(points.period)[:, None] + nodes.position).ravel()
    return SteDatabase(
        position=position,
        force=request.load,
        torque=request.torque,
        misalignment=request.misalignment,
        center_distance_change=request.center_distance_change,
        facts=pair_facts(request.pair),
        period=points.period,
        error_estimate=np.full((position.size, request.load.size, *points.shape), np.nan),
        metadata=Metadata(),
        **table_fields(points, solved),
        **(table_support(points, support) if support else {}),
    )
