"""Analyze a design anew as `analyze` would, with the errors of its curves, at every node of the scatter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache as cached
from functools import partial
from pathlib import Path

import numpy as np

from bounds import SiNote
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.model_choice import Decided, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request, checked_request
from fe_contact.errors import InputError, finite, integer, within
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.confirmed_figures import confirmed_figures
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.evaluator import Evaluation, Evaluator, deviating
from fe_contact.microgeometry.objective import NO_LIMITS, Limits
from fe_contact.microgeometry.root_influence import RootInfluence
from fe_contact.microgeometry.scatter import MISALIGNMENT, ONE_NODE, Scatter
from fe_contact.microgeometry.variables import effect_of, figure, modified
from fe_contact.options import LARGEST_DEVIATION, AnalysisOptions, Levels, Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate, FloatArray, IntArray
from model_studies import NOT_STORED, in_unit
from model_studies.stage_clock import StageClock

# The loads at which designs are assessed: torques, each with the misalignment of the mesh under it.

SAME = 1e-12
"""Misalignments that differ by less, in m, are one: sums of the same two differ in their last bits."""
Misalignments = float | Levels
"""One value for all loads, or one for each, m."""
CALLED_FOR = "called for by designs that remove less"
"""The reason of an effect that is on although the design by which effects are decided does without."""


@dataclass(frozen=True)
class DesignLoads:
    """L loads, by rising torque; loads of one torque differ in their misalignment."""

    torque: FloatArray
    """On the driving gear, N m. Shape (L,)."""
    misalignment: FloatArray
    """Growth of the gap over the common face width, m: shafts, bearings and housing yield with the torque.
    Shape (L,).
    """

    @classmethod
    def of(cls, torques: Levels, misalignment: Misalignments) -> DesignLoads:
        """Return the loads of torques in N m and of their misalignments in m.

        Raises `InputError`: no torque, torques that fall, one load twice, or another number of misalignments
        than one or one for each torque.
        """
        torque = np.array([finite(f"torques[{i}]", value) for i, value in enumerate(torques)])
        if not torque.size:
            raise InputError("torques", [], "a non-empty list of finite numbers")
        skew = np.broadcast_to(_misalignments(misalignment, torque.size), torque.shape)
        if np.any(np.diff(torque) < 0.0) or len({*zip(torque, skew, strict=True)}) < torque.size:
            bound = "increasing, and equal only at different misalignments"
            raise InputError("torques", torque.tolist(), bound, "Sort the list and drop repeats.")
        return cls(torque, skew)

    def with_torques(self, further: Levels) -> tuple[DesignLoads, IntArray]:
        """Return the loads (T,) with further torques among them, and which of all are the own ones (L,).

        Misalignments of further torques are linear between the loads, held beyond the lowest and highest.
        """
        added = np.setdiff1d(further, self.torque)
        torque = np.concatenate([self.torque, added])
        between = np.interp(added, self.torque, self.misalignment)
        order = np.argsort(torque, kind="stable")
        everything = DesignLoads(torque[order], np.concatenate([self.misalignment, between])[order])
        return everything, np.flatnonzero(order < self.torque.size)


def misalignment_axis(misalignment: FloatArray, deviation: FloatArray) -> FloatArray:
    """Return the axis of a table that holds misalignments (L,) with none and with each deviation (S,), m."""
    own = np.concatenate([misalignment, np.add.outer(deviation, misalignment).ravel()])
    rising = np.unique(own)
    return np.asarray(rising[np.append(True, np.diff(rising) > SAME)])


def snapped_to_axis(axis: FloatArray, misalignment: FloatArray) -> FloatArray:
    """Return misalignments, those of the axis (M,) to its last bit, m."""
    nearest = axis[np.abs(axis - misalignment[..., None]).argmin(axis=-1)]
    return np.where(np.abs(nearest - misalignment) <= SAME, nearest, misalignment)


def _misalignments(given: Misalignments, loads: int) -> FloatArray:
    values = np.atleast_1d(np.asarray(given, dtype=object)).tolist()
    if len(values) not in (1, loads):
        raise InputError("misalignment", values, f"one number, or {loads}, one for each torque")
    ends, advice = (-LARGEST_DEVIATION, LARGEST_DEVIATION), SiNote("In m: 10 µm is 1e-5.")
    names = [f"misalignment[{i}]" for i in range(len(values))] if np.ndim(given) else ["misalignment"]
    return np.array([within(*each, *ends, advice) for each in zip(names, values, strict=True)])


# The start of every study of a pair's micro-geometry: one model, one compliance, one evaluator.


@dataclass(frozen=True)
class DesignStudy:
    """A pair whose designs can be assessed."""

    decided: Decided
    """Model and discretization, of all designs and all torques."""
    loads: DesignLoads
    """All T of them: those of the full analysis."""
    force: FloatArray
    """Their normal forces, N. Shape (T,)."""
    counted: IntArray
    """Which of them count; the others are for maps. Shape (L,)."""
    evaluator: Evaluator
    """At the loads that count."""

    @property
    def torque(self) -> FloatArray:
        """Torques that count (L,), N m."""
        return np.asarray(self.loads.torque[self.counted])


@dataclass(frozen=True)
class DesignSpace:
    """The designs of a pair and their assessment."""

    pair: ParallelAxes
    varied: Mapping[str, float]
    """``gear.quantity`` to m of a design in which nothing that is varied is zero: by it the effects are
    decided.
    """
    scatter: Scatter
    misalignment: Misalignments
    """About which it scatters, m: one value, or one for each torque."""
    positions: int
    """Equally spaced in a base pitch."""
    options: AnalysisOptions
    """Their `positions`, `receipt` and `on_violation` do not count."""
    least: Mapping[str, float] = field(default_factory=dict)
    """``gear.quantity`` to m of the design with the least removed; effects that it calls for are on."""

    def check(self, torques: Levels, further_torques: Levels = ()) -> Checked:
        """Check the request of a design in which everything acts that may act in any; computes nothing.

        `torques`, `further_torques`: those that count, each with its misalignment, and others that the table
        has, N m. Raises `InputError`: a value that cannot be used, or something is varied whose effect is
        off.
        """
        integer("positions", self.positions, 8, 4096, "64 resolve a spur pair.")
        loads = DesignLoads.of(torques, self.misalignment)
        scattered = self.scatter.modification
        present = {name: figure(self.pair, name) for name in scattered} | dict(self.varied)
        acting = {name: own + _toward(name) * scattered.get(name, 0.0) for name, own in present.items()}
        skews = misalignment_axis(loads.misalignment, self.scatter.nodes().misalignment)
        axes = TableAxes(np.union1d(loads.torque, further_torques), misalignments=skews)
        options = replace(self.options, positions=None, receipt="full", on_violation="report")
        checked = check_request(modified(self.pair, acting), axes, options, neglect=False)
        _refuse_off(checked, self.varied, self.scatter)
        barest = check_request(self._with_the_least_removed(), axes, options, neglect=False)
        return _with_effects_of(barest, checked)

    def _with_the_least_removed(self) -> ParallelAxes:
        """Return the pair with every variable at its lower bound, less what scatters."""
        present = {name: figure(self.pair, name) for name in self.scatter.modification} | dict(self.varied)
        removed = present | dict(self.least)
        deviation = {name: -amount for name, amount in self.scatter.modification.items()}
        return deviating(modified(self.pair, removed), deviation)


def _with_effects_of(barest: Checked, checked: Checked) -> Checked:
    """Turn on what only the design with the least removed calls for: tip edges that a relief keeps apart."""
    missing = [entry.name for entry in checked.ledger if entry.choice == "auto" and not entry.on]
    reasons = {name: CALLED_FOR for name in missing if barest.decided[name] == "on"}
    if not reasons:
        return checked
    turned_on = {**checked.request.turned_on, **reasons}
    return checked_request(replace(checked.request, turned_on=turned_on), neglect=False)


def _toward(name: str) -> float:
    """Return the sign of a deviation that acts: hollow flanks stand at their ends, where tip edges touch."""
    return -1.0 if name.endswith("_form") else 1.0


def design_study(
    space: DesignSpace,
    torques: Levels,
    further_torques: Levels,
    clock: StageClock,
    run: Run,
    checked: Checked | None = None,
    limits: Limits = NO_LIMITS,
) -> DesignStudy:
    """Choose the model and condense the gears.

    Raises `InputError` as `DesignSpace.check`.

    Parameters
    ----------
    torques, further_torques : sequence of float
        Those that count, and those that only maps show, N m.
    run : Run
        Only this process works.
    checked : Checked, optional
        Of `DesignSpace.check`, where that is done.
    limits : Limits
        One of the root stress has its unit loads solved.
    """
    own = DesignLoads.of(torques, space.misalignment)
    loads, counted = own.with_torques(further_torques)
    with clock.stage("planning"):
        decided = _on_one_mesh(checked or space.check(torques, further_torques), run.cache)
    run.progress("compliance", 0.0)
    with clock.stage("compliance"):
        report = partial(run.progress, "compliance")
        contact = pair_contact(space.pair, decided.plan, run.cache, report=report)
    run.progress("compliance", 1.0)
    position, nodes = np.arange(space.positions) / space.positions, space.scatter.nodes()
    level = np.searchsorted(np.unique(loads.torque), loads.torque)  # the table has every torque once
    force = decided.checked.request.load[level]
    varied, choices = replace(contact, varied=True), decided.checked.decided
    roots = None
    if limits.root_stress is not None:
        with clock.stage("root stress"):
            roots = RootInfluence.of(contact, run.cache)
    evaluator = Evaluator(varied, choices, position, force[counted], own.misalignment, nodes, roots)
    return DesignStudy(decided, loads, force, counted, evaluator)


def _on_one_mesh(checked: Checked, cache: Path | None) -> Decided:
    """Return model and mesh by the requested accuracy, every effect decided for good."""
    decided = decide(checked, cache)
    request = decided.checked.request
    options = replace(request.options, effects=decided.checked.decided)
    fixed = replace(request, options=options, neglected={}, turned_on={})
    return replace(decided, checked=checked_request(fixed, neglect=False))


def _refuse_off(checked: Checked, varied: Mapping[str, float], scatter: Scatter) -> None:
    """Refuse to vary what an effect that is off would hide."""
    request = checked.request
    shown = {name: effect_of(name, request.registry) for name in (*varied, *scatter.modification)}
    if scatter.misalignment:
        shown[MISALIGNMENT] = request.named(MISALIGNMENT)
    for name, effect in shown.items():
        if checked.decided[effect] == "off":
            bound = f'"on" or "auto" where {name} is varied'
            raise InputError(f"effects.{effect}", "off", bound, "Or leave it out of the variables.")


# Harris map of a design: transmission error over position at several loads, and its ripple over load.
#
# Harris, S. L.: "Dynamic loads on the teeth of spur gears", Proceedings of the Institution of Mechanical
# Engineers 172 (1958), 87-112.


@dataclass(frozen=True)
class HarrisMap:
    """Curves of one design at T torques, and their ripple at S nodes of the scatter."""

    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    """On the driving gear, N m, increasing. Shape (T,)."""
    position: FloatArray
    """Base pitches. Shape (P,)."""
    ste: FloatArray = field(metadata=in_unit("m", "position", "torque"))
    """Without scatter, m. Shape (P, T)."""
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    nominal_error: FloatArray = field(metadata=in_unit("m", "torque"))
    """`nominal`, `nominal_error`: Peak-to-peak without scatter and its error, m. Shape (T,) each."""
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "node", "torque"))
    error: FloatArray = field(metadata=in_unit("m", "node", "torque"))
    """`peak_to_peak`, `error`: At the nodes, m. The error is that of the table at the node's misalignment:
    deviations of the modification change the ripple, not the discretization. Shape (S, T) each.
    """
    weight: FloatArray
    """Of the nodes. Shape (S,)."""

    @property
    def expected(self) -> FloatArray:
        """Expectation over the scatter (T,), m."""
        return np.asarray(self.weight @ self.peak_to_peak)

    @property
    def expected_error(self) -> FloatArray:
        """Its error (T,) in m: errors of the nodes may all have the same sign."""
        return np.asarray(self.weight @ self.error)


def rising(before: HarrisMap, after: HarrisMap) -> IntArray:
    """Return the indices of torques at which the expected ripple rises by more than the errors of both."""
    change = after.expected - before.expected
    return np.flatnonzero(change > before.expected_error + after.expected_error)


@dataclass(frozen=True)
class ConfirmedDesign:
    """A design as analyzed in full."""

    values: dict[str, float]
    """``gear.quantity`` to m."""
    harris_map: HarrisMap
    figures: Evaluation
    """Pressures, factors and curves at the nodes and the torques that count."""
    objective: Estimate
    """Its error adds that of the analysis and that of the scatter's rule."""
    scatter_error: float = field(metadata=in_unit("m"))
    """The latter, m."""
    violation: float
    """Of the limits, in parts of them."""
    table: SteDatabase | None = field(default=None, metadata=NOT_STORED)
    """Over torques and misalignments, without scatter of the modifications; of a stored design None."""


def confirm(
    problem: DesignProblem, values: Mapping[str, float], study: DesignStudy, cache: Path | None
) -> ConfirmedDesign:
    """Analyze a design in full, over all torques of a study.

    Parameters
    ----------
    values : mapping
        ``gear.quantity`` to m.
    cache : Path, optional
        Directory of flank compliances.
    """
    search, nodes, counted = problem.evaluator, problem.evaluator.nodes, study.counted
    table = full_table(search, values, study.decided, cache)
    fine = replace(search.at(table.position), load=study.force, misalignment=study.loads.misalignment)
    figures, exact = confirmed_figures(fine, values, cache), replace(fine, nodes=ONE_NODE)
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
        pair=modified(search.contact.pair, values),
        misalignment=skews,
        options=replace(request.options.at_level(decided.mesh.level), effects=dict(search.choices)),
    )
    checked = checked_request(full, neglect=False)
    table = compute_database(checked, full.to_json(), Run(cache=cache), replace(decided, checked=checked))
    table.require_complete()
    return table


def ripple_errors(table: SteDatabase, fine: Evaluator) -> FloatArray:
    """Return errors of peak-to-peak (S, T), m: those of the table at the nodes and loads of an evaluator."""

    @cached
    def error(load: float, skew: float) -> float:
        return table.peak_to_peak(force=load, misalignment=skew).error

    rows = snapped_to_axis(table.misalignment, fine.misalignments).tolist()
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
