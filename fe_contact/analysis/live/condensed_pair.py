"""A pair whose bodies are condensed: other flanks, loads and alignments are a matter of contact alone.

The compliance of a gear depends on its macro geometry, not on its flank modifications, the load, the
alignment or the center distance. With the compliance in memory a new curve needs no finite elements, only
gaps and contact. Its errors cost about as much again.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np

from bounds import at_most
from fe_contact.analysis.checks.assumptions import check_cheaply
from fe_contact.analysis.checks.table_laws import check_laws, require_laws
from fe_contact.analysis.estimates.assessed_table import unassessed_table
from fe_contact.analysis.estimates.table_sample import TableSample
from fe_contact.analysis.live.condensed_assumptions import edge_assumptions, neglected_assumptions
from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.live.condensed_errors import condensed_errors
from fe_contact.analysis.live.condensed_receipt import condensed_receipt
from fe_contact.analysis.pairs.operating_points import OperatingPoints, operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.pairs.solved_contact import SolvedContact
from fe_contact.analysis.position_nodes import PositionNodes, unmeasured_nodes
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.analysis.tables import assembled_table
from fe_contact.contact import Start
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.options import TableAxes
from fe_contact.planning.cost_model import condensed_teeth
from fe_contact.planning.plan import LARGEST_SUPPORT, Plan
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.types import FloatArray
from model_studies.stage_clock import StageClock

PLANE_POSITIONS, FACE_POSITIONS = 192, 64
"""Equally spaced positions of a base pitch, in the plane and over the face. The compliance at them is
assembled once for all flanks. In the plane handovers are steep, and positions cost little.
"""
MAX_ROWS = 4096
"""Most positions of a period of several base pitches, where teeth differ."""
FEWEST_POSITIONS = 16
"""Least number of positions of a base pitch of such a period."""
CACHED_DISTANCES = 2
"""Changes of the center distance at which the compliance stays assembled."""


class _CondensedProblem(NamedTuple):
    """Data of a contact solution: request, bodies with the flanks, operating point, positions and plan."""

    checked: Checked
    contacts: CondensedContacts
    points: OperatingPoints
    nodes: PositionNodes
    plan: Plan


@dataclass
class _Latest:
    """The latest preview, from whose forces the next one starts."""

    preview: SolvedOperatingPoint | None = None


@dataclass(frozen=True)
class CondensedPair:
    """Gears with the compliance of a table, for other flanks, loads and alignments."""

    checked: Checked
    """Request of the table, its model bound to the bodies of the table."""
    contacts: CondensedContacts
    """Contacts at the nominal center distance. They keep the assembled compliance of the positions."""
    neglected: Mapping[str, str] = field(default_factory=dict)
    """Effects of the bodies that the tolerance of the table neglected, each with the reason."""
    _by_distance: OrderedDict[float, CondensedContacts] = field(default_factory=OrderedDict, repr=False)
    _latest: _Latest = field(default_factory=_Latest, repr=False)

    @property
    def contact(self) -> PairContact:
        """The pair at its nominal center distance."""
        return self.contacts.fine

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
            Torques on the driving gear in N m, increasing, > 0.
        misalignment : float
            Growth of the gap over the common face width in the plane of action, m.
        center_distance_change : float
            Deviation from the nominal center distance, m. Each one has its own compliance between the teeth,
            of which the last few stay in memory.

        Returns
        -------
        SteDatabase
            Table at equally spaced positions; corner contact is on unless the table's case switched it off.
            It has no support loads, so no forces for dynamics, and between its loads no errors. The receipt
            has the errors by source, CPU time by stage, assumptions, and the number of points at which a
            contact strip outgrew its load patch.
        """
        table, _ = self.solve_table(pair, torques, misalignment, center_distance_change)
        return table

    def solve_table(
        self,
        pair: ParallelAxes,
        torques: FloatArray,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
        *,
        preview: bool = False,
    ) -> tuple[SteDatabase, SolvedOperatingPoint]:
        """Return the table, as `table` does, and its contact solution.

        A `preview` has every other position and no errors; its solution starts from the preview before it.
        """
        clock = StageClock()
        checked = self._request_at(pair, torques, misalignment, center_distance_change)
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
            # only previews start from another solution: results do not depend on earlier questions
            solved = _solved_point(checked, plan, points, nodes, self._latest.preview if preview else None)
            if preview:
                self._latest.preview = solved
            contact = SolvedContact.of(solved.pair, solved.problem, solved.solution)
            table = assembled_table(checked.request, points, nodes, [contact], [])
            laws = check_laws(table, points.places, [(contact.problem, contact.solution)])
            require_laws(laws, table)
        with clock.stage("error estimate"):
            if preview:
                assessed = unassessed_table(table, points, plan)
            else:
                assessed = condensed_errors(table, solved, contacts, sample)
        checks = (*check_cheaply(solved), *edge_assumptions(solved), *neglected_assumptions(self.neglected))
        receipt = condensed_receipt(solved, assessed, checks, clock)
        origin = "expected" if contacts.coarse is None else "measured"
        receipt["discretisation_error"] = None if preview else origin
        ledger = [{"name": entry.name, "on": entry.on} for entry in checked.ledger]
        metadata = Metadata(effect_ledger=ledger, receipt=receipt)
        return assessed.with_errors(table, metadata), solved

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
        problem = self.contact_problem(pair, torques, misalignment, center_distance_change)
        return _solved_point(problem.checked, problem.plan, problem.points, problem.nodes)

    def solve_rougher(
        self,
        pair: ParallelAxes,
        torques: FloatArray,
        misalignment: float = 0.0,
        center_distance_change: float = 0.0,
    ) -> tuple[SolvedOperatingPoint, ...]:
        """Solve the contact in half the slices and on the coarse meshes, as far as these exist.

        The changes of a result on the flanks measure its error. Parameters and errors are those of `table`.
        """
        problem = self.contact_problem(pair, torques, misalignment, center_distance_change)
        return tuple(
            _solved_point(problem.checked, problem.plan, problem.points.on(rougher), problem.nodes)
            for rougher in (problem.contacts.sliced, problem.contacts.coarse)
            if rougher is not None
        )

    def contact_problem(
        self, pair: ParallelAxes, torques: FloatArray, misalignment: float, change: float
    ) -> _CondensedProblem:
        """Return the data of a contact solution; parameters and errors are those of `table`."""
        checked = self._request_at(pair, torques, misalignment, change)
        nodes, plan = self._laid_out(checked)
        contacts, points = self._placed(checked)
        return _CondensedProblem(checked, contacts, points, nodes, plan)

    def _request_at(
        self, pair: ParallelAxes, torques: FloatArray, misalignment: float, change: float
    ) -> Checked:
        known = self.checked.request.pair
        if _plain(pair) != _plain(known):
            bound = "with the gears and the center distance of the table; only flank modifications may differ"
            raise InputError("pair", "another", bound, "Analyze the other pair first.")
        axes = TableAxes(torques=torques, misalignments=[misalignment], center_distance_changes=[change])
        load = axes.load(pair)
        if load[-1] > self.largest_load * (1.0 + 1e-9):
            limit = float(pair.torque(np.array([self.largest_load]))[0])
            highest = at_most(limit, note=f": {LARGEST_SUPPORT:g} times the highest load of the table")
            remedy = "Analyze the case with a higher load."
            raise InputError(f"torques[{load.size - 1}]", float(torques[-1]), highest, remedy)
        return self._checked(pair, axes)

    def _checked(self, pair: ParallelAxes, axes: TableAxes) -> Checked:
        """Compose the model of other flanks on the condensed bodies."""
        request = self.checked.request
        name = request.named("corner_contact")
        choice = request.options.effects.get(name, "auto")
        # on for every curve: whether tip edges touch depends on the flanks, and one compliance serves all
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
            check_size=False,
            neglect=False,
        )

    def _laid_out(self, checked: Checked) -> tuple[PositionNodes, Plan]:
        limit = FACE_POSITIONS if checked.model.across_face else PLANE_POSITIONS
        count = int(np.clip(MAX_ROWS // checked.model.period, FEWEST_POSITIONS, limit))
        load = checked.request.load
        return unmeasured_nodes(count, load.size), replace(self.contact.plan, load=load, positions=count)

    def _placed(self, checked: Checked) -> tuple[CondensedContacts, OperatingPoints]:
        """Return the contacts of the flanks at the requested distance, and their operating point."""
        request = checked.request
        contacts = self._at(float(request.center_distance_change[0]))
        distance = contacts.fine.pair.center_distance
        nominal = distance == request.pair.center_distance
        pair = request.pair if nominal else request.pair.at_center_distance(distance)
        bodies = contacts.with_flanks(pair)
        # the contacts are at the requested distance: the scene has no further change
        scene = replace(request.scene, center_distance_change=np.zeros(1))
        return bodies, operating_points(scene, request.choices, bodies.fine)

    def _at(self, change: float) -> CondensedContacts:
        """Return the contacts at a change of the center distance in m; the latest ones stay in memory."""
        if change == 0.0:
            return self.contacts
        if change not in self._by_distance:
            contacts = self.contacts.at_distance(change)
            _refuse_more_teeth(contacts.fine, change)
            self._by_distance[change] = contacts
        self._by_distance.move_to_end(change)
        while len(self._by_distance) > CACHED_DISTANCES:
            self._by_distance.popitem(last=False)
        return self._by_distance[change]


def _solved_point(
    checked: Checked,
    plan: Plan,
    points: OperatingPoints,
    nodes: PositionNodes,
    last: SolvedOperatingPoint | None = None,
) -> SolvedOperatingPoint:
    """Solve the one operating point at all positions of a period, started from the `last` solution."""
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
    flank, _ = contact.plane
    teeth, needed = int(flank.teeth.size), condensed_teeth(contact.pair)
    if needed > teeth:
        bound = f"a change at which at most {teeth} teeth can touch: so many are condensed, {needed} can"
        remedy = "Add it to the axis of the case and analyze the case."
        raise InputError("center_distance_changes[0]", change, bound, remedy)


def _plain(pair: Any) -> list[object]:
    """Return types and fields of a pair and its gears, without the modification of their flanks."""
    gears = pair.pinion, pair.wheel
    content: list[object] = [type(pair), *map(type, gears)]
    for part, left_out in ((pair, ("pinion", "wheel")), *((gear, ("modification",)) for gear in gears)):
        content += [getattr(part, field.name) for field in fields(part) if field.name not in left_out]
    return content
