"""Positions of a table, and what is solved at them.

A table as solved, before its errors are known: plan, positions, solutions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bounds import engineering
from fe_contact.analysis.cycle.derived_pitches import DerivedCycle, derived_cycle
from fe_contact.analysis.pairs.contact_lines import deflected_operating_points, solve_operating_points
from fe_contact.analysis.pairs.kept_contact import OF_PAIRS, OF_SUPPORT, KeptContact, contact_fields
from fe_contact.analysis.pairs.pair_contact import (
    OperatingPoints,
    PairContact,
    operating_points,
    pair_contact,
)
from fe_contact.analysis.request.model_choice import Decided, decide
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.request.solved_run import SolvedRun, edges_left_out
from fe_contact.compliance.remote_condensation import condense_remotely, condensing
from fe_contact.contact import ContactModel, ContactProblem, ContactSolution
from fe_contact.contact.model import MeetingTeeth
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run
from fe_contact.planning.cost_model import Prediction, expected_tries, most_positions, unit_work
from fe_contact.planning.cost_of_derivatives import CycleSeconds
from fe_contact.planning.plan import FaceDiscretization, NodeRule, Plan
from fe_contact.ste import Metadata, PairFacts, SteDatabase
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import BoolArray, FloatArray, IntArray, Status
from model_studies.progress import Report, announce, by_cost, unreported
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess, pays

# Positions of the database: equally spaced, or denser where the curves bend.

MAX_ROUNDS = 10
PROBES = np.array([0.25, 0.5, 0.75])
"""Points of every interval where the interpolant is held against a solution; the middle becomes a node."""


@dataclass(frozen=True)
class PositionNodes:
    """Nodes over one base pitch with the interpolation error between them."""

    position: FloatArray
    """Increasing in [0, 1). Shape (P,)."""
    interval_error: FloatArray
    """Difference in m between interpolant and solution in the interval after each node, at the worst probe;
    (T P, L) where it is known for each of T base pitches. NaN where it was not requested. Shape (P, L).
    """
    value: FloatArray
    middle: FloatArray
    """`value`, `middle`: STE in m at the nodes and in the middle of the interval after each. Ndarray, shapes
    (P, L) or (T P, L).
    """

    @property
    def error(self) -> FloatArray:
        """Largest error beside each node, m; shape of `interval_error`."""
        return np.maximum(self.interval_error, np.roll(self.interval_error, 1, axis=0))


def unmeasured_nodes(count: int, columns: int) -> PositionNodes:
    """`count` equally spaced nodes between which nothing is measured, for L columns of curves."""
    unknown = np.full((count, columns), np.nan)
    return PositionNodes(np.arange(count) / count, unknown, unknown, unknown)


def _adaptive_nodes(rule: NodeRule, solve: Callable[[FloatArray], FloatArray]) -> PositionNodes:
    """Bisect the intervals in which the interpolant misses a probe.

    `solve` gives the STE (W, P, L) in m at positions (P,): of one base pitch that repeats (W = 1), or of
    one with the pitch before and the pitch after it (W = 3).

    The slope of STE jumps where a pair comes into contact, at a position that moves with load, so a few
    hundred nodes gather at the handovers. The search ends with the tolerance met, after `MAX_ROUNDS`, or
    at the largest number; the error says which.
    """
    nodes = np.arange(rule.start) / rule.start
    values = solve(nodes)
    settled = np.zeros(rule.start, dtype=bool)
    error, between = np.full(values.shape[1:], np.inf), np.zeros_like(values)
    for remaining in reversed(range(MAX_ROUNDS)):
        own = values[values.shape[0] // 2]
        allowed = rule.tolerance * rule.ripple(own)
        middles, at_middle, probed = _probed(nodes, values, solve, ~settled, PROBES)
        error[~settled], between[:, ~settled] = probed[~settled], at_middle[:, ~settled]
        missed = np.any(error > allowed, axis=1)
        if not missed.any() or not remaining or nodes.size + missed.sum() > rule.most:
            break
        nodes, values, settled, error, between = _inserted(nodes, values, missed, middles, between, error)
    own = values.shape[0] // 2
    return PositionNodes(nodes, error, values[own], between[own])


def _probed(
    nodes: FloatArray,
    values: FloatArray,
    solve: Callable[[FloatArray], FloatArray],
    open_: BoolArray,
    probes: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles, solutions there, and largest errors at the probes, of the open intervals (others zero)."""
    spacing = Axis(nodes, 1.0).spacing
    where = nodes[open_, None] + spacing[open_, None] * probes
    solved = solve(where.ravel())
    own = solved[solved.shape[0] // 2]
    missed = np.abs(_interpolated(nodes, values, where.ravel()) - own).reshape(*where.shape, -1)
    at_middle, error = np.zeros_like(values), np.zeros(values.shape[1:])
    at_middle[:, open_] = solved.reshape(solved.shape[0], *where.shape, -1)[:, :, probes.size // 2]
    error[open_] = missed.max(axis=1)
    return nodes + 0.5 * spacing, at_middle, error


def _interpolated(nodes: FloatArray, values: FloatArray, where: FloatArray) -> FloatArray:
    """Interpolant (Q, L) of the middle one of W base pitches, at `where` in [0, 1]; all of them repeat."""
    pitches = np.arange(values.shape[0]) - values.shape[0] // 2
    knots = (pitches[:, None] + nodes).ravel()
    return interpolate(Axis(knots, float(pitches.size)), values.reshape(knots.size, -1), where)


def _inserted(
    nodes: FloatArray,
    values: FloatArray,
    missed: BoolArray,
    middles: FloatArray,
    at_middle: FloatArray,
    error: FloatArray,
) -> tuple[FloatArray, FloatArray, BoolArray, FloatArray, FloatArray]:
    """Insert the middles of the missed intervals; both halves and the neighbors are measured again."""
    touched = missed | np.roll(missed, 1) | np.roll(missed, -1)
    order = np.argsort(np.concatenate([nodes, middles[missed]]), kind="stable")
    merged = np.concatenate([nodes, middles[missed]])[order]
    return (
        merged,
        np.concatenate([values, at_middle[:, missed]], axis=1)[:, order],
        np.concatenate([~touched, np.zeros(int(missed.sum()), dtype=bool)])[order],
        np.concatenate([error, np.full((int(missed.sum()), error.shape[1]), np.inf)])[order],
        np.concatenate([at_middle, np.zeros_like(at_middle[:, missed])], axis=1)[:, order],
    )


# The positions of a table: one set for all its alignments and base pitches.


def _table_nodes(points: OperatingPoints, plan: Plan, report: Report = unreported) -> PositionNodes:
    """Place the positions: the number requested, or where the assessed curves bend.

    What is missed between fixed ones is not measured here (`position_errors`). `report` is called with the
    fraction of the positions that a search usually tries.
    """
    if plan.positions is not None:
        return unmeasured_nodes(plan.positions, len(points.assessed) * plan.load.size)
    pitches = _assessed_pitches(points.nominal.pair, points.places[0].model, plan.nodes.assessed_pitches)
    times = points.period * len(points.places)
    tried, expected = 0, expected_tries(points.nominal.pair, plan, points.period, len(points.places))

    def solve(position: FloatArray) -> FloatArray:
        """STE (W, P, pitches x places x L) in m; beside the pitches NaN where interpolants do not reach."""
        nonlocal tried
        own = _curves(points, plan.load, position, pitches)
        tried += position.size
        report(min(tried / expected, 1.0))
        if points.period == 1:
            return own
        near = plan.nodes.reached_beside(position)
        values = np.full((3, *own.shape[1:]), np.nan)
        values[1] = own[0]
        for way in (-1, 1) if near.any() else ():
            values[1 + way, near] = _curves(points, plan.load, position[near], pitches + way)[0]
        return values

    return _adaptive_nodes(replace(plan.nodes, most=most_positions(plan, times)), solve)


def _assessed_pitches(pair: ParallelAxes, model: ContactModel, most: int) -> IntArray:
    """Return base pitches to assess.

    Where all teeth are alike, the one pitch there is. Else pitches m, at most `most`, evenly taken from all
    in the order of how much the gaps of the pairs at m - 1, m, m + 1 differ, both ends among them: these
    differences move and steepen the handovers.
    """
    if model.period == 1:
        return np.zeros(1, dtype=np.int64)
    meeting = np.arange(model.period)[:, None] + np.arange(-1, 2)
    spread = np.ptp(model.gap_of_teeth(MeetingTeeth.at_pitch_point(pair, meeting)), axis=1)
    order = np.argsort(spread, kind="stable")
    chosen = np.linspace(0, order.size - 1, min(most, order.size)).astype(np.int64)
    return np.asarray(order[np.unique(chosen)])


def _curves(points: OperatingPoints, load: FloatArray, position: FloatArray, pitches: IntArray) -> FloatArray:
    """STE (1, P, pitches x places x L) in m of the assessed operating points in pitches (T,)."""
    curves = deflected_operating_points(
        points.assessed, [position] * len(points.assessed), load, pitches, points.workers
    )
    shape = (pitches.size, position.size, -1)
    by_pitch = np.concatenate([curve[..., 0].reshape(shape) for curve in curves], axis=2)
    return np.concatenate(np.split(by_pitch, pitches.size), axis=2)


@dataclass(frozen=True)
class SolvedTable(SolvedRun):
    """One run up to its table."""

    decided: Decided
    """Model and discretization."""
    prediction: Prediction
    """What it was expected to cost."""
    nodes: PositionNodes
    kept: Sequence[KeptContact]
    support: Sequence[KeptContact]
    """`kept`, `support`: Of every place at the loads of the table, and at the support loads."""
    table: SteDatabase
    """Its errors not yet estimated."""
    condition: FloatArray | None = None
    """Condition numbers of the compliances, where workers found them."""
    derived: DerivedCycle | None = None
    """What came of derivatives, where they were tried."""

    @property
    def edge_depths(self) -> list[FloatArray]:
        """See `SolvedRun`; they were found with the solutions."""
        return [each.edge_depth for each in self.kept]


def solve_table(
    checked: Checked,
    clock: StageClock,
    run: Run,
    before: SolvedTable | None = None,
    decided: Decided | None = None,
) -> SolvedTable:
    """Plan and solve a request, by workers if that pays.

    Parameters
    ----------
    before : SolvedTable, optional
        The same pair with other effects: its compliance is taken if the bodies are the same.
    decided : Decided, optional
        Model and discretization; default: those that the accuracy asks for.
    """
    full = checked.request.options.receipt == "full"
    with clock.stage("planning"):
        decided = decided or decide(checked, run.cache)
        checked, plan, request = decided.checked, decided.plan, decided.checked.request
        prediction = checked.predicted(plan, run.cache, with_errors=full)
        run = run if pays(run.workers, prediction.cpu_seconds) else replace(run, workers=InProcess())
    known = before.places.nominal if before is not None and _same_bodies(before.plan, plan) else None
    run.on_plan(prediction.stages)
    announce(run.progress, "compliance", prediction.cpu_seconds, _subject(checked, prediction))
    report = partial(run.progress, "compliance")
    nominal = condensed_bodies(checked, plan, clock, run, known=known, report=report)
    points = operating_points(request.scene, request.choices, nominal, run.workers)
    with clock.stage("contact"):
        progress = by_cost(partial(run.progress, "contact"), prediction.parts["contact"])
        nodes = _table_nodes(points, plan, partial(progress, "positions"))
        points, sets, condition, derived = _solved_places(
            points, nodes.position, decided, full=full, report=partial(progress, "table")
        )
        kept, support = sets
        table = assembled_table(request, points, nodes, kept, support)
        run.progress("contact", 1.0)
    solved = [(each.problem, each.solution) for each in kept]
    return SolvedTable(
        checked, plan, points, solved, decided, prediction, nodes, kept, support, table, condition, derived
    )


def _solved_places(
    points: OperatingPoints, position: FloatArray, decided: Decided, *, full: bool, report: Report
) -> tuple[OperatingPoints, list[list[KeptContact]], FloatArray | None, DerivedCycle | None]:
    """Solve all places, their pitches by derivatives where that is predicted to take less.

    Returns the places, what is kept of them for each set of loads, condition numbers where workers found
    them, and what came of derivatives where they were tried.
    """
    checked, plan, known = decided.checked, decided.plan, None
    loads, edges = (plan.load, plan.support), edges_left_out(checked)
    sizes = [each.size for each in loads]
    pair = checked.request.pair
    work = unit_work(pair, plan, plan.discretization.slices)
    predicted = CycleSeconds.of(work, pair, points.period, position.size, sizes)
    if full and predicted.pays_in_table(points.period):
        known = derived_cycle(points, position, loads, checked.request.options, edges=edges)
        if known.tables:
            report(1.0)
            return known.places, known.kept, None, known
    kept, condition = solve_operating_points(
        points, position, loads, conditioned=full, edges=edges, report=report
    )
    return points, kept, condition, known


def _subject(checked: Checked, prediction: Prediction) -> str:
    """Return what is announced, and its memory where the period is long."""
    period, gigabytes = checked.model.period, 1e-9 * prediction.memory_bytes
    return "table" if period == 1 else f"table of {period} base pitches in {engineering(gigabytes, 2)} GB"


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
    first, second = ((plan.discretization, plan.parts) for plan in (own, other))
    return first == second


def assembled_table(
    request: Request,
    points: OperatingPoints,
    nodes: PositionNodes,
    kept: Sequence[KeptContact],
    support: Sequence[KeptContact],
) -> SteDatabase:
    """Assemble the table, its errors not yet estimated; `support` may be empty."""
    position = (np.arange(points.period)[:, None] + nodes.position).ravel()
    return SteDatabase(
        position=position,
        force=request.load,
        torque=request.torque,
        misalignment=request.misalignment,
        center_distance_change=request.center_distance_change,
        facts=PairFacts.of(request.pair),
        period=points.period,
        error_estimate=np.full((position.size, request.load.size, *points.shape), np.nan),
        metadata=Metadata(),
        **table_fields(points, kept),
        **(table_support(points, support) if support else {}),
    )


# From what is kept of the contact to the arrays of the STE database.


def table_of_solution(
    pair: ParallelAxes,
    problem: ContactProblem,
    solution: ContactSolution,
    position: FloatArray,
    misalignment: float,
) -> SteDatabase:
    """Return a solution of one alignment, at the center distance of `pair`, as a table without errors.

    Parameters
    ----------
    position : ndarray, shape (P,)
        Those of one base pitch, which the solution may repeat.
    misalignment : float
        m.
    """
    period = len(solution.deflection) // position.size
    fields = contact_fields(pair, problem, solution)
    if period == 1:
        del fields["pair_pressure"]
    return SteDatabase(
        position=(np.arange(period)[:, None] + position).ravel(),
        force=solution.load,
        torque=pair.torque(solution.load),
        misalignment=np.array([misalignment]),
        center_distance_change=np.zeros(1),
        facts=PairFacts.of(pair),
        period=period,
        error_estimate=np.full((*solution.deflection.shape, 1, 1), np.nan),
        metadata=Metadata(),
        pair=np.unique(problem.candidates.pair),
        no_load_transmission_error=solution.no_load[:, None, None],
        **{name: values[:, :, None, None] for name, values in fields.items()},
    )


def table_fields(points: OperatingPoints, kept: Sequence[KeptContact]) -> dict[str, NDArray[Any]]:
    """Arrays of the database at the requested loads, (P, F, M, D, ...), and its pair axis."""
    seen = np.concatenate([each.problem.candidates.pair for each in kept])
    pairs = np.arange(seen.min(), seen.max() + 1)
    stored = [dict(each.stored) for each in kept]
    for arrays, each in zip(stored, kept, strict=True):
        own = np.unique(each.problem.candidates.pair)
        if points.period == 1:
            del arrays["pair_pressure"]
        for name in arrays.keys() & OF_PAIRS:
            values = arrays[name]
            arrays[name] = np.zeros((*values.shape[:2], pairs.size))
            arrays[name][..., own - pairs[0]] = values
    no_load = points.gathered([each.solution.no_load[:, None] for each in kept])[:, 0]
    gathered = {name: points.gathered([arrays[name] for arrays in stored]) for name in stored[0]}
    return gathered | {"pair": pairs, "no_load_transmission_error": no_load}


def table_support(points: OperatingPoints, kept: Sequence[KeptContact]) -> dict[str, NDArray[Any]]:
    """Support loads that converged everywhere, and their arrays (P, S, M, D)."""
    good = np.all([each.solution.status == Status.CONVERGED for each in kept], axis=(0, 1))
    arrays = {name: points.gathered([each.stored[name][:, good] for each in kept]) for name in OF_SUPPORT}
    support = {f"support_{name.removeprefix('static_')}": values for name, values in arrays.items()}
    return support | {"support_force": kept[0].solution.load[good]}
