"""The solved table of a run, before its errors are known: plan, positions, solutions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bounds import engineering
from fe_contact.analysis.cycle.derived_pitches import DerivedCycle, derived_cycle
from fe_contact.analysis.pairs.contact_lines import solve_operating_points
from fe_contact.analysis.pairs.operating_points import OperatingPoints, operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.pairs.solved_contact import SolvedContact
from fe_contact.analysis.position_nodes import PositionNodes, table_nodes
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.request.solved_run import SolvedRun, edges_neglected
from fe_contact.analysis.table_fields import table_fields, table_support
from fe_contact.compliance.remote_condensation import condense_remotely, condensing
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run
from fe_contact.planning.cost_model import Prediction, unit_work
from fe_contact.planning.cost_of_derivatives import CycleSeconds
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.plan import Plan
from fe_contact.ste import Metadata, PairGeometry, SteDatabase
from fe_contact.types import FloatArray
from model_studies.progress import Report, announce, by_cost, unreported
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess, pays


@dataclass(frozen=True)
class SolvedTable(SolvedRun):
    """A run up to its solved table."""

    decision: Decision
    """Model and discretization."""
    prediction: Prediction
    """Predicted cost of the run."""
    nodes: PositionNodes
    contacts: Sequence[SolvedContact]
    support: Sequence[SolvedContact]
    """`contacts`, `support`: Contacts of every operating point at the loads of the table, and at the support
    loads.
    """
    table: SteDatabase
    """Table whose errors are not yet estimated."""
    condition: FloatArray | None = None
    """Condition numbers of the compliances, where workers found them."""
    derived: DerivedCycle | None = None
    """Outcome of the derivatives over the cycle; None where they were not tried."""

    @property
    def edge_depths(self) -> list[FloatArray]:
        """Largest depths of tip edges inside the mating flanks at every operating point, (L,) in m."""
        return [contact.edge_depth for contact in self.contacts]


def solve_table(
    checked: Checked,
    clock: StageClock,
    run: Run,
    before: SolvedTable | None = None,
    decision: Decision | None = None,
) -> SolvedTable:
    """Plan and solve a request, by workers if that pays.

    Parameters
    ----------
    before : SolvedTable, optional
        The same pair with other effects: its compliance is taken if the bodies are the same.
    decision : Decision, optional
        Model and discretization; default: those that the accuracy asks for.
    """
    full = checked.request.options.receipt == "full"
    with clock.stage("planning"):
        decision = decision or decide(checked, run.cache)
        checked, plan, request = decision.checked, decision.plan, decision.checked.request
        prediction = checked.predicted(plan, run.cache, with_errors=full)
        run = run if pays(run.workers, prediction.cpu_seconds) else replace(run, workers=InProcess())
    known = before.places.nominal if before is not None and _same_bodies(before.plan, plan) else None
    run.on_plan(prediction.stages)
    announce(run.progress, "compliance", prediction.cpu_seconds, _subject(checked, prediction))
    report = partial(run.progress, "compliance")
    nominal = condensed_bodies(checked, plan, clock, run, contact=known, report=report, coarse_next=full)
    points = operating_points(request.scene, request.choices, nominal, run.workers)
    with clock.stage("contact"):
        progress = by_cost(partial(run.progress, "contact"), prediction.parts["contact"])
        nodes = table_nodes(points, plan, partial(progress, "positions"))
        points, sets, condition, derived = _solved_places(
            points, nodes.position, decision, full=full, report=partial(progress, "table")
        )
        contacts, support = sets
        table = assembled_table(request, points, nodes, contacts, support)
        run.progress("contact", 1.0)
    solved = [(contact.problem, contact.solution) for contact in contacts]
    return SolvedTable(
        checked=checked,
        plan=plan,
        places=points,
        solved=solved,
        decision=decision,
        prediction=prediction,
        nodes=nodes,
        contacts=contacts,
        support=support,
        table=table,
        condition=condition,
        derived=derived,
    )


def _solved_places(
    points: OperatingPoints, position: FloatArray, decision: Decision, *, full: bool, report: Report
) -> tuple[OperatingPoints, list[list[SolvedContact]], FloatArray | None, DerivedCycle | None]:
    """Solve all places, their pitches by derivatives where that is predicted to take less.

    Returns the places, what is kept of them for each set of loads, condition numbers where workers found
    them, and what came of derivatives where they were tried.
    """
    checked, plan, known = decision.checked, decision.plan, None
    loads, edges = (plan.load, plan.support), edges_neglected(checked)
    sizes = [levels.size for levels in loads]
    pair = checked.request.pair
    work = unit_work(pair, plan, plan.discretization.slices)
    predicted = CycleSeconds.of(work, pair, points.period, position.size, sizes)
    if full and predicted.pays_in_table(points.period):
        known = derived_cycle(points, position, loads, checked.request.options, edges=edges)
        if known.tables:
            report(1.0)
            return known.places, known.contacts, None, known
    contacts, condition = solve_operating_points(
        points, position, loads, conditioned=full, edges=edges, report=report
    )
    return points, contacts, condition, known


def _subject(checked: Checked, prediction: Prediction) -> str:
    """Return the subject of the progress report, with its memory where the period is long."""
    period, gigabytes = checked.model.period, 1e-9 * prediction.memory_bytes
    return "table" if period == 1 else f"table of {period} base pitches in {engineering(gigabytes, 2)} GB"


def condensed_bodies(
    checked: Checked,
    plan: Plan,
    clock: StageClock,
    run: Run,
    *,
    coarse: bool = False,
    contact: PairContact | None = None,
    report: Report = unreported,
    coarse_next: bool = False,
) -> PairContact:
    """Compute or fetch the compliances of both gears, fine or coarse, as a stage of the run.

    `coarse_next`: as of `pair_contact`.
    """
    request = checked.request
    report(0.0)
    with clock.stage("error estimate" if coarse else "compliance"):
        changes = request.center_distance_change
        nominal = contact or _condensed_contact(request.pair, plan, coarse, changes, run, report, coarse_next)
    report(1.0)
    return nominal


def _condensed_contact(
    pair: ParallelAxes,
    plan: Plan,
    coarse: bool,
    changes: FloatArray,
    run: Run,
    report: Report,
    coarse_next: bool,
) -> PairContact:
    """Condense the gears, those of three dimensions by the workers if there are any."""
    made = plan.discretization
    if isinstance(condensing(run.workers), InProcess) or not isinstance(made, FaceDiscretization):
        return pair_contact(pair, plan, run.cache, coarse, changes, report, coarse_next=coarse_next)
    with TemporaryDirectory() as folder:
        cache = run.cache or Path(folder)
        recipes = made.coarse_recipes if coarse else made.recipes
        condense_remotely(plan.bodies(pair), recipes, cache, run.workers, report)
        return pair_contact(pair, plan, cache, coarse, changes)


def _same_bodies(plan: Plan, other: Plan) -> bool:
    first, second = ((plan.discretization, plan.parts) for plan in (plan, other))
    return first == second


def assembled_table(
    request: Request,
    points: OperatingPoints,
    nodes: PositionNodes,
    contacts: Sequence[SolvedContact],
    support: Sequence[SolvedContact],
) -> SteDatabase:
    """Assemble the table, its errors not yet estimated; `support` may be empty."""
    position = (np.arange(points.period)[:, None] + nodes.position).ravel()
    return SteDatabase(
        position=position,
        force=request.load,
        torque=request.torque,
        misalignment=request.misalignment,
        center_distance_change=request.center_distance_change,
        geometry=PairGeometry.of(request.pair),
        period=points.period,
        error_estimate=np.full((position.size, request.load.size, *points.shape), np.nan),
        metadata=Metadata(),
        **table_fields(points, contacts),
        **(table_support(points, support) if support else {}),
    )
