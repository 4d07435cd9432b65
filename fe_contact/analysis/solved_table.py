"""A table as solved, before its errors are known: plan, places, positions, solutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fe_contact.analysis.decided import Decided
from fe_contact.analysis.model_choice import decide
from fe_contact.analysis.operating_points import OperatingPoints, operating_points
from fe_contact.analysis.pair_contact import PairContact, pair_contact
from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.analysis.request import Checked, Request
from fe_contact.analysis.solved_operating_points import Solved, solve_operating_points
from fe_contact.analysis.table_nodes import table_nodes
from fe_contact.analysis.tabulate import pair_facts, table_fields, table_support
from fe_contact.compliance.remote_condensation import condense_remotely
from fe_contact.geometry import ParallelAxes
from fe_contact.planning import FaceDiscretization, Plan, Prediction, predict_run
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess, Workers

Progress = Callable[[str, float], None]


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
    report: Progress,
    cache: Path | None,
    before: SolvedTable | None = None,
    decided: Decided | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SolvedTable:
    """Plan and solve a request.

    Parameters
    ----------
    checked : Checked
    clock : StageClock
    report : callable
        Called as report(stage, fraction).
    cache : Path, optional
        Directory of flank compliances.
    before : SolvedTable, optional
        The same pair with other effects: its compliance is taken if the bodies are the same.
    decided : Decided, optional
        Model and discretization; default: those that the accuracy asks for.
    workers : Workers
        Who condenses the gears and solves the contact.
    """
    full = checked.request.accuracy.receipt == "full"
    with clock.stage("planning"):
        decided = decided or decide(checked, cache)
        checked, plan, request = decided.checked, decided.plan, decided.checked.request
        wanted = request.pair, plan, checked.model, request.alignments
        prediction = predict_run(*wanted, cache, with_errors=full)
    known = before.places.nominal if before is not None and _same_bodies(before.plan, plan) else None
    nominal = condensed_bodies(checked, plan, clock, report, cache, known=known, workers=workers)
    places = operating_points(request.scene, request.choices, nominal, workers)
    with clock.stage("contact"):
        nodes = table_nodes(places, plan)
        report("contact", 0.3)
        loads = plan.load, plan.support
        (solved, support), condition = solve_operating_points(places, nodes.position, loads, conditioned=full)
        table = assembled_table(request, places, nodes, solved, support)
        report("contact", 1.0)
    return SolvedTable(decided, prediction, places, nodes, solved, support, table, condition)


def condensed_bodies(
    checked: Checked,
    plan: Plan,
    clock: StageClock,
    report: Progress,
    cache: Path | None,
    *,
    coarse: bool = False,
    known: PairContact | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> PairContact:
    """Compute or fetch the compliances of both gears, fine or coarse, as a stage of the run."""
    request, stage = checked.request, "error estimate" if coarse else "compliance"
    report(stage, 0.0)
    with clock.stage(stage):
        changes = request.center_distance_change
        nominal = known or _condensed(request.pair, plan, cache, coarse, changes, workers)
    report(stage, 1.0)
    return nominal


def _condensed(
    pair: ParallelAxes,
    plan: Plan,
    cache: Path | None,
    coarse: bool,
    changes: FloatArray,
    workers: Workers,
) -> PairContact:
    """Condense the gears, those of three dimensions by the workers if there are any."""
    made = plan.discretization
    if isinstance(workers, InProcess) or not isinstance(made, FaceDiscretization):
        return pair_contact(pair, plan, cache, coarse, changes)
    with TemporaryDirectory() as folder:
        kept = cache or Path(folder)
        recipes = made.coarse_recipes if coarse else made.recipes
        condense_remotely(plan.bodies(pair), recipes, kept, workers)
        return pair_contact(pair, plan, kept, coarse, changes)


def _same_bodies(one: Plan, other: Plan) -> bool:
    """Whether two plans of one pair have the same finite elements."""
    first, second = ((plan.discretization, plan.thin_rim, plan.bore_seat) for plan in (one, other))
    return first == second


def assembled_table(
    request: Request, places: OperatingPoints, nodes: PositionNodes, solved: Solved, support: Solved
) -> SteDatabase:
    """Assemble the table, its errors not yet estimated; `support` may be empty."""
    position = (np.arange(places.period)[:, None] + nodes.position).ravel()
    return SteDatabase(
        position=position,
        force=request.load,
        torque=request.torque,
        misalignment=request.misalignment,
        center_distance_change=request.center_distance_change,
        facts=pair_facts(request.pair),
        period=places.period,
        error_estimate=np.full((position.size, request.load.size, *places.shape), np.nan),
        metadata=Metadata(),
        **table_fields(places, solved),
        **(table_support(places, support) if support else {}),
    )
