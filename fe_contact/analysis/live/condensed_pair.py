"""A pair whose bodies are condensed: other flanks, loads and alignments are a matter of contact alone.

The compliance of a gear depends on its macro geometry, not on its flank modifications, the load, the
alignment or the center distance. With it in memory a new curve costs the gaps and the contact, no finite
elements; and its errors about as much again.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from bounds import at_most
from fe_contact.analysis.checks.assumptions import Assumption, check_cheaply
from fe_contact.analysis.checks.table_laws import check_laws, require_laws
from fe_contact.analysis.database.compute_database import failed_points
from fe_contact.analysis.estimates.assessed_table import (
    AssessedTable,
    curve_errors,
    estimate_errors,
    interval_errors,
    load_arm_errors,
    table_bias,
    unassessed_table,
    worst_residual,
)
from fe_contact.analysis.estimates.position_errors import errors_by_halves
from fe_contact.analysis.estimates.table_sample import Nested, TableSample
from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.pairs.kept_contact import KeptContact
from fe_contact.analysis.pairs.pair_contact import OperatingPoints, PairContact, operating_points
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint, SolvedRun
from fe_contact.analysis.tables import PositionNodes, assembled_table, unmeasured_nodes
from fe_contact.contact import Start
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.options import TableAxes
from fe_contact.planning.cost_model import condensed_teeth
from fe_contact.planning.plan import LARGEST_SUPPORT, Plan
from fe_contact.planning.planned import usual_mesh_error
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.curve import AT_NODES, BETWEEN_NODES
from fe_contact.ste.curve_quantities import MEAN, QUANTITIES
from fe_contact.types import FloatArray, Json
from model_studies.stage_clock import StageClock

# Errors of a table that was solved on a condensed pair, at a part of the cost of solving it.
#
# The rougher discretizations are those of an analysis, at half of the positions or fewer, and the parts of
# their changes that are left are the same. What is between the positions is told by half of them. Coarse
# meshes that are not at hand are no reason to compute any: the error known of the level stands in.

OVER_MEDIAN = 2.0
"""Factor on the median error of a level: nine runs of ten state less."""
BY_MESH = AT_NODES.index("discretisation")


def _condensed_errors(
    table: SteDatabase, run: SolvedOperatingPoint, contacts: CondensedContacts, sample: TableSample
) -> AssessedTable:
    """Estimate the errors of a table of one alignment.

    `contacts` have the same flanks on rougher discretizations, assembled at the `sample`, whose points are
    solved again. Between the loads nothing is estimated (NaN): the table is of the loads asked.
    """
    points, solution, plan = run.places, run.solution, run.plan
    start = sample.start(run.problem, solution)
    starts = None if start is None else [start]

    def solved(rougher: PairContact | None, otherwise: FloatArray) -> FloatArray:
        if rougher is None:
            return otherwise
        return sample.solved(points.on(rougher), points, starts)

    own = sample.taken(table)
    plane = solved(contacts.plane, own)
    patched = solved(contacts.patched, own)
    coarse = solved(contacts.coarse, patched)
    nested = Nested(sample, own, plane, patched, coarse, solved(contacts.sliced, own))
    positions = errors_by_halves(table.position, solution.deflection, points.period)
    ste, arms = nested.parts
    measured = points, [(run.problem, solution)], ste, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    if contacts.coarse is None:
        errors[BY_MESH], band = _expected(table, plan, contacts.own)
        sources = replace(sources, discretization=np.broadcast_to(band, sources.contact.shape))
    bias = table_bias(table, points, plan)
    of_arm = load_arm_errors(points, table, arms, plan)
    _, between = interval_errors(errors.shape[2:], {})
    every = np.concatenate([errors, between])
    nowhere = np.empty((0,) * 4)  # no point between nodes is assessed
    return AssessedTable(sources.total, every, of_arm, nowhere, None, sources.to_json(), {}, bias)


def _expected(table: SteDatabase, plan: Plan, contact: PairContact) -> tuple[FloatArray, FloatArray]:
    """Return what the level of the meshes is known to leave, (23, F, 1, 1), and its band (1, F, 1, 1), m.

    A harmonic may be wrong by as much as peak-to-peak. A misaligned pair leads at no load, and so may its
    mean: what the meshes are wrong by then hangs on what the load adds.
    """
    ste = np.nan_to_num(table.static_transmission_error)
    added = (ste - np.nan_to_num(table.no_load_transmission_error)[:, None]).mean(axis=0)
    mean = np.maximum(ste.mean(axis=0), added)
    errors = np.empty((QUANTITIES, *mean.shape))
    of_mean, of_ripple = usual_mesh_error(contact.pair, plan)
    errors[:] = OVER_MEDIAN * of_ripple * mean
    errors[MEAN] = OVER_MEDIAN * of_mean * mean
    return errors, errors[MEAN][None] + 0.5 * errors[MEAN + 1][None]


# Assumptions of a condensed pair's table: what can be checked on the solution alone is, the rest is named and
# has no verdict (`holds` None).


def _edges(run: SolvedRun) -> Iterator[Assumption]:
    """Without corner contact: edges would have to be laid out, which assembles another compliance."""
    if not run.checked.model.corner_contact:
        reason = "not checked: corner contact is switched off by the case"
        effect = run.checked.request.named("corner_contact")
        yield Assumption(effect, "tip edges stay clear", None, float("nan"), reason)


def _neglected(neglected: Mapping[str, str]) -> Iterator[Assumption]:
    """Effects of the bodies that were neglected for a tolerance, assessed by the flanks of the case."""
    for name, why in neglected.items():
        reason = f"not checked on these flanks: {why}"
        yield Assumption(name, "neglected effects are negligible", None, float("nan"), reason)


# The receipt of a condensed pair's table: errors by source, cost by stage, assumptions.


def _condensed_receipt(
    run: SolvedOperatingPoint, assessed: AssessedTable, assumptions: Sequence[Assumption], clock: StageClock
) -> Json:
    errors = assessed.to_json()
    missing = [name for name in errors["not_estimated"] if name not in BETWEEN_NODES]
    known = {name: value for name, value in errors["curve_error"].items() if name not in BETWEEN_NODES}
    return (
        clock.to_json()
        | errors
        | {
            "curve_error": known,
            "not_estimated": missing,
            "plan": run.plan.to_json(),
            "beyond_load_patches": int(run.solution.beyond.sum()),
            "residuals_max": worst_residual(run.solution),
            "failed_points": failed_points([run.solution]),
            "assumptions": [assumption.to_json() for assumption in assumptions],
        }
    )


PLANE_POSITIONS, FACE_POSITIONS = 192, 64
"""Of a base pitch, equally spaced: the compliance at them is assembled once for all flanks. In the plane
handovers are steep, and positions cost little."""
MOST_ROWS, FEWEST_POSITIONS = 4096, 16
"""Of longer periods, which repeat the positions in every base pitch."""
KEPT_DISTANCES = 2
"""Changes of the center distance at which the compliance stays assembled."""


@dataclass
class _Latest:
    preview: SolvedOperatingPoint | None = None


@dataclass(frozen=True)
class CondensedPair:
    """Gears with their compliance, as a table had them."""

    checked: Checked
    """What the table was asked, its model bound to the bodies it had."""
    contacts: CondensedContacts
    """At the nominal center distance; they keep what was assembled for the positions."""
    neglected: Mapping[str, str] = field(default_factory=dict)
    """Effects of the bodies that the tolerance of the table neglected, and why."""
    _apart: OrderedDict[float, CondensedContacts] = field(default_factory=OrderedDict, repr=False)
    _latest: _Latest = field(default_factory=_Latest, repr=False)

    @property
    def contact(self) -> PairContact:
        """The pair at its nominal center distance."""
        return self.contacts.own

    @property
    def largest_load(self) -> float:
        """Highest normal force in N for which the load patches were laid out."""
        return LARGEST_SUPPORT * float(self.checked.request.load[-1])

    def table(
        self,
        pair: ParallelAxes,
        torques: FloatArray,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
    ) -> SteDatabase:
        """Solve the contact of the same bodies with other flanks.

        Raises `InputError`: other bodies, loads beyond those of the table, flanks that its model cannot hold,
        or a center distance at which more teeth meet than are condensed.

        Parameters
        ----------
        pair : GearPair or InternalGearPair
            The same macro geometry with any flank modification.
        torques : ndarray, shape (F,)
            On the driving gear in N m, increasing, > 0.
        misalignment : float
            Growth of the gap over the common face width in the plane of action, m.
        center_distance_change : float
            In m. The compliance between the teeth is assembled anew at another one, and the last few kept.

        Returns
        -------
        SteDatabase
            At equally spaced positions; corner contact is on unless the table's case switched it off. It has
            no support loads, so no forces for dynamics, and between its loads no errors. The receipt has the
            errors by source, CPU time by stage, what was taken for granted, and the number of points at
            which a contact strip outgrew its load patch.
        """
        return self.solve_table(pair, torques, misalignment, center_distance_change)[0]

    def solve_table(
        self,
        pair: ParallelAxes,
        torques: FloatArray,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
        *,
        preview: bool = False,
    ) -> tuple[SteDatabase, SolvedOperatingPoint]:
        """Return the table, as `table` does, and the contact solution that it is of.

        A `preview` is the same solution at every other position, found from the preview before it; its errors
        are not estimated.
        """
        clock = StageClock()
        checked = self._asked(pair, torques, misalignment, center_distance_change)
        nodes, plan = self._laid_out(checked)
        load, alignment = plan.load, (checked.request.misalignment, checked.request.center_distance_change)
        sample = TableSample.of(nodes.position, checked.model.period, (load, *alignment))
        with clock.stage("compliance"):
            contacts, points = self._placed(checked)
            model, count = points.places[0].model, sample.position.size
            contacts.assemble(model, sample)
            if preview:
                rows = np.arange(0, count, 2 - count % 2)  # equally spaced
                contacts.keep(model, sample.position, rows)
                nodes, plan = unmeasured_nodes(rows.size, load.size), replace(plan, positions=rows.size)
                sample = replace(sample, position=nodes.position, rows=np.arange(rows.size))
        with clock.stage("contact"):
            contacts.touch(model, sample)
            # what stays is solved from the beginning: it does not depend on what came before
            solved = _solved(checked, plan, points, nodes, self._latest.preview if preview else None)
            if preview:
                self._latest.preview = solved
            kept = KeptContact.of(solved.pair, solved.problem, solved.solution)
            table = assembled_table(checked.request, points, nodes, [kept], [])
            laws = check_laws(table, points.places, [(kept.problem, kept.solution)])
            require_laws(laws, table)
        with clock.stage("error estimate"):
            stated = unassessed_table(table, points, plan) if preview else None
            assessed = stated or _condensed_errors(table, solved, contacts, sample)
        checks = (*check_cheaply(solved), *_edges(solved), *_neglected(self.neglected))
        receipt = _condensed_receipt(solved, assessed, checks, clock)
        origin = "expected" if contacts.coarse is None else "measured"
        receipt["discretisation_error"] = None if preview else origin
        ledger = [{"name": entry.name, "on": entry.on} for entry in checked.ledger]
        metadata = Metadata(effect_ledger=ledger, receipt=receipt)
        return assessed.stated(table, metadata), solved

    def solve(
        self,
        pair: ParallelAxes,
        torques: FloatArray,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
    ) -> SolvedOperatingPoint:
        """Solve the contact alone, at the positions of `table`: no table, no errors.

        Parameters and errors are those of `table`.
        """
        checked, _, points, nodes, plan = self.posed(pair, torques, misalignment, center_distance_change)
        return _solved(checked, plan, points, nodes)

    def solve_rougher(
        self,
        pair: ParallelAxes,
        torques: FloatArray,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
    ) -> tuple[SolvedOperatingPoint, ...]:
        """Solve the contact in half the slices and on the coarse meshes, whichever there are.

        What this changes of a result on the flanks is a measure of its error. Parameters and errors are those
        of `table`.
        """
        question = pair, torques, misalignment, center_distance_change
        checked, contacts, points, nodes, plan = self.posed(*question)
        return tuple(
            _solved(checked, plan, points.on(rougher), nodes)
            for rougher in (contacts.sliced, contacts.coarse)
            if rougher is not None
        )

    def posed(
        self, pair: ParallelAxes, torques: FloatArray, misalignment: float, change: float
    ) -> tuple[Checked, CondensedContacts, OperatingPoints, PositionNodes, Plan]:
        """Return what the contact is solved with: request, bodies with the flanks, positions and plan.

        Parameters and errors are those of `table`.
        """
        checked = self._asked(pair, torques, misalignment, change)
        nodes, plan = self._laid_out(checked)
        return checked, *self._placed(checked), nodes, plan

    def _asked(self, pair: ParallelAxes, torques: FloatArray, misalignment: float, change: float) -> Checked:
        known = self.checked.request.pair
        if _plain(pair) != _plain(known):
            bound = "with the gears and the center distance of the table; only flank modifications may differ"
            raise InputError("pair", "another", bound, "Analyze the other pair first.")
        axes = TableAxes(torques=torques, misalignments=[misalignment], center_distance_changes=[change])
        self._refuse_beyond_patches(pair, torques, axes.load(pair))
        return self._checked(pair, axes)

    def _refuse_beyond_patches(self, pair: ParallelAxes, torques: FloatArray, load: FloatArray) -> None:
        if load[-1] > self.largest_load * (1.0 + 1e-9):
            most = float(pair.torque(np.array([self.largest_load]))[0])
            bound = at_most(most, note=f": {LARGEST_SUPPORT:g} times the highest load of the table")
            advice = "Analyze the case with a higher load."
            raise InputError(f"torques[{load.size - 1}]", float(torques[-1]), bound, advice)

    def _checked(self, pair: ParallelAxes, axes: TableAxes) -> Checked:
        """Compose the model of other flanks on the bodies there are."""
        request = self.checked.request
        name = request.named("corner_contact")
        choice = request.options.effects.get(name, "auto")
        # always on: what a tip edge does is then in every curve, and one compliance serves them all
        corners = "on" if choice == "auto" else choice
        effects = {**request.options.effects, name: corners}
        return checked_request(
            replace(
                request,
                pair=pair,
                load=axes.load(pair),
                misalignment=axes.misalignment,
                center_distance_change=axes.center_distance_change,
                options=replace(request.options, effects=effects),
            ),
            whole_table=False,
            neglect=False,
        )

    def _laid_out(self, checked: Checked) -> tuple[PositionNodes, Plan]:
        most = FACE_POSITIONS if checked.model.across_face else PLANE_POSITIONS
        count = int(np.clip(MOST_ROWS // checked.model.period, FEWEST_POSITIONS, most))
        load = checked.request.load
        return unmeasured_nodes(count, load.size), replace(self.contact.plan, load=load, positions=count)

    def _placed(self, checked: Checked) -> tuple[CondensedContacts, OperatingPoints]:
        """Return the contacts of the flanks at the requested distance, and the operating point they make."""
        request = checked.request
        contacts = self._at(float(request.center_distance_change[0]))
        distance = contacts.own.pair.center_distance
        nominal = distance == request.pair.center_distance
        pair = request.pair if nominal else request.pair.at_center_distance(distance)
        here = contacts.with_flanks(pair)
        scene = replace(request.scene, center_distance_change=np.zeros(1))  # the contacts stand there
        return here, operating_points(scene, request.choices, here.own)

    def _at(self, change: float) -> CondensedContacts:
        """Return the contacts at a change of the center distance in m; those requested last are kept."""
        if change == 0.0:
            return self.contacts
        if change not in self._apart:
            apart = self.contacts.apart(change)
            _refuse_more_teeth(apart.own, change)
            self._apart[change] = apart
        self._apart.move_to_end(change)
        while len(self._apart) > KEPT_DISTANCES:
            self._apart.popitem(last=False)
        return self._apart[change]


def _solved(
    checked: Checked,
    plan: Plan,
    points: OperatingPoints,
    nodes: PositionNodes,
    last: SolvedOperatingPoint | None = None,
) -> SolvedOperatingPoint:
    """Solve the one place of a question at all positions of a period, started from the `last` one."""
    start, rows = None, nodes.position.size * points.period
    if last is not None and last.solution.status.shape == (rows, plan.load.size):
        rise = (plan.load / last.solution.load)[:, None]
        start = Start(last.problem.candidates, last.solution.force * rise)
    solved = points.places[0].solve_pitches(nodes.position, plan.load, np.arange(points.period), start)
    return SolvedOperatingPoint(checked, plan, points, [solved])


def _refuse_more_teeth(contact: PairContact, change: float) -> None:
    """Refuse a distance at which more teeth may touch than the compliance in the plane has."""
    if contact.plane is None:
        return
    teeth, needed = int(contact.plane[0].teeth.size), condensed_teeth(contact.pair)
    if needed > teeth:
        bound = f"a change at which at most {teeth} teeth can touch: so many are condensed, {needed} can"
        advice = "Add it to the axis of the case and analyze the case."
        raise InputError("center_distance_changes[0]", change, bound, advice)


def _plain(pair: Any) -> list[object]:
    """Return what a pair is but for the modification of its flanks."""
    gears = pair.pinion, pair.wheel
    sizes = [getattr(pair, each.name) for each in fields(pair) if each.name not in ("pinion", "wheel")]
    for gear in gears:
        sizes += [getattr(gear, each.name) for each in fields(gear) if each.name != "modification"]
    return [type(pair), *map(type, gears), *sizes]
