"""A table as solved, before its errors are known: plan, places, positions, solutions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoints, operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.pairs.solved_operating_points import (
    Solved,
    deflected_operating_points,
    solve_operating_points,
)
from fe_contact.analysis.pairs.tabulate import pair_facts, table_fields, table_support
from fe_contact.analysis.request.decided import Decided
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.tables.position_nodes import (
    PositionNodes,
    adaptive_nodes,
    unmeasured_nodes,
)
from fe_contact.compliance.remote_condensation import condense_remotely, condensing
from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run
from fe_contact.planning import MOST_ROWS, FaceDiscretization, Plan, Prediction, predict_run
from fe_contact.planning.contact_cost import expected_tries
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.types import FloatArray, IntArray
from fe_contact.workers import InProcess
from model_studies.progress import Report, by_cost, unreported

# The positions of a table: one set for all its alignments and base pitches.


def _table_nodes(points: OperatingPoints, plan: Plan, report: Report = unreported) -> PositionNodes:
    """Place the positions: the number requested, or where the assessed curves bend.

    What is missed between fixed ones is not measured here (`position_errors`). `report` is called with the
    fraction of the positions that a search usually tries.
    """
    if plan.positions is not None:
        return unmeasured_nodes(plan.positions, len(points.assessed) * plan.load.size)
    windows = assessed_windows(points.places[0].model, plan.nodes.assessed_pitches)
    tried, expected = 0, expected_tries(plan)

    def solve(position: FloatArray) -> FloatArray:
        """STE (W, P, windows x places x L) in m."""
        nonlocal tried
        curves = [_curves(points, plan.load, position, window) for window in windows]
        tried += position.size
        report(min(tried / expected, 1.0))
        return np.concatenate(curves, axis=2)

    rows = points.period * len(points.places)
    most = max(min(plan.nodes.most, MOST_ROWS // rows), plan.nodes.start)
    return adaptive_nodes(replace(plan.nodes, most=most), solve)


def assessed_windows(model: ContactModel, most: int) -> tuple[IntArray, ...]:
    """Return base pitches to assess, each with its neighbors.

    Where all teeth are alike, the one pitch there is: ``([0],)``. Else ``[m - 1, m, m + 1]`` of pitches m, at
    most `most`, evenly taken from all in the order of how much the gaps of their three pairs differ, both
    ends among them: these differences move and steepen the handovers.
    """
    if model.period == 1:
        return (np.zeros(1, dtype=np.int64),)
    meeting = np.arange(model.period)[:, None] + np.arange(-1, 2)
    spread = np.ptp(sum(term(meeting) for term in model.tooth_gaps), axis=1)
    order = np.argsort(spread, kind="stable")
    chosen = np.unique(np.linspace(0, order.size - 1, min(most, order.size)).astype(int))
    return tuple(order[k] + np.arange(-1, 2) for k in chosen)


def _curves(points: OperatingPoints, load: FloatArray, position: FloatArray, pitches: IntArray) -> FloatArray:
    """STE (T, P, places x L) in m of the assessed operating points in the given pitches."""
    curves = deflected_operating_points(
        points.assessed, [position] * len(points.assessed), load, pitches, points.workers
    )
    shape = (pitches.size, position.size, -1)
    return np.concatenate([curve.reshape(shape) for curve in curves], axis=2)


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
        nodes = _table_nodes(points, plan, partial(progress, "positions"))
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
