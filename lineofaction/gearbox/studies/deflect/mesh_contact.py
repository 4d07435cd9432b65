"""The contact of a mesh on its condensed gears: tables by misalignment, and the load on its flanks.

A condensed gear is its compliance at the flank nodes, held in memory: a contact at another load or alignment
is solved without a new mesh. A knot is a misalignment, m, at which a table is computed; between knots the
tables are interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dynamics.meshes import MeshTable
from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.flanks.load_distribution import LoadDistribution, load_distribution
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.ste.joined_tables import joined_over_misalignment
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.case import PLANE, analysis_options, gear_pair
from lineofaction.gearbox.schemas import Case
from model_studies.progress import Report, unreported
from model_studies.workers import Workers, divided, spent

LOWEST, HIGHEST = 0.5, 1.25
"""Outermost torques of the tables: over the lowest and over the highest torque of the load cases."""

FIRST_MISALIGNMENT = 1e-6
"""Misalignment, m, in a request: any value but 0 makes the planner choose bodies in three dimensions."""

ALIKE = 1e-6
"""Relative difference of torques up to which they are one load of the table."""


@dataclass(frozen=True)
class MeshContact:
    """The contact of a mesh on gears whose compliance is in memory."""

    pair: ParallelAxes
    bodies: CondensedPair
    torques: FloatArray
    """Torques on the case's pinion, N m: torques of the load cases, a lower and a higher one. Shape (F,)."""
    tables: dict[float, SteDatabase] = field(default_factory=dict, repr=False)
    """Tables computed so far, by misalignment, m."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the recipe to copy the contact for a task: without the tables, which no task needs."""
        return type(self), (self.pair, self.bodies, self.torques)

    @property
    def across_face(self) -> bool:
        """Whether the load may vary over the face; a plane model takes no misalignment."""
        return bool(self.bodies.checked.model.across_face)

    def table(self, misalignments: Sequence[float]) -> MeshTable:
        """Return the mesh-force table over increasing misalignments, m, whose tables have been computed."""
        tables = [self.tables[misalignment] for misalignment in misalignments]
        return joined_over_misalignment(tables).force_table()

    def solved(
        self, torque: float, misalignment: float, change: float
    ) -> tuple[SteDatabase, LoadDistribution]:
        """Solve one load and alignment; return the table of it and the load distribution on the flanks.

        `torque` on the case's pinion is in N m, `misalignment` and `change` of the center distance in m.
        """
        table, solution = self.bodies.solve_table(self.pair, np.array([torque]), misalignment, change)
        return table, load_distribution(
            solution.pair,
            solution.problem,
            solution.solution,
            misalignment=misalignment,
            center_distance_change=change,
        )

    @staticmethod
    def of(case: Case, database: SteDatabase, torques: Sequence[float], run: Run) -> MeshContact:
        """Return the contact of a case for loads on its pinion, N m.

        `database` is the table of the case. Its bodies are used if it reaches the highest torque, and if it
        is in three dimensions or the case demands a plane model. Otherwise a small table with such bodies is
        computed.
        """
        pair = gear_pair(case)
        loads = _distinct(torques)
        levels = np.array([LOWEST * loads[0], *loads, HIGHEST * loads[-1]])
        suitable = database  # a table with the bodies that are needed
        is_plane = case.accuracy.model in PLANE
        ends_too_low = loads[-1] > database.torque[-1] * (1.0 + ALIKE)
        if not is_plane and (ends_too_low or database.metadata.receipt["plan"]["model"] in PLANE):
            axes = TableAxes(torques=loads, misalignments=[-FIRST_MISALIGNMENT, FIRST_MISALIGNMENT])
            # only the bodies are used: few positions and no error estimate
            options = replace(analysis_options(case), receipt="minimal", positions=8)
            suitable = analyze(pair, axes, options, run)
        elif ends_too_low:
            options = replace(analysis_options(case), receipt="minimal")
            suitable = analyze(pair, TableAxes(torques=loads), options, run)
        bodies = condensed_pair(pair, suitable, dict(case.effects), run.cache, compute=True)
        assert bodies is not None  # `compute` fills the cache
        return MeshContact(pair, bodies, levels)


@dataclass
class DividedTables:
    """Tables at the knots of all contacts, which workers compute, one table a task."""

    contacts: Mapping[str, MeshContact]
    """Contacts by the name of the mesh; equal meshes share one contact."""
    workers: Workers
    seconds: float
    """CPU seconds of a table: as predicted at first, then as measured in the last pass."""
    report: Report = unreported
    """Callback for the fraction done of all tables."""
    usual: int = 0
    """Number of tables in a usual number of passes; later ones count in no fraction."""
    _done: int = field(default=0, init=False)

    def complete(self, knots: Mapping[str, Sequence[float]]) -> None:
        """Compute the tables at misalignments, m, by mesh, that have not been computed yet."""
        # meshes that share a contact get its tables under the first of their names: of equal keys the last
        # stays
        first = {id(contact): name for name, contact in reversed(list(self.contacts.items()))}
        requested = (
            (first[id(self.contacts[name])], knot)
            for name, misalignments in knots.items()
            for knot in misalignments
        )
        new = [
            (name, knot) for name, knot in dict.fromkeys(requested) if knot not in self.contacts[name].tables
        ]
        initial = spent(self.workers)
        tables = divided(self.workers, _table_at, self.contacts, new, self.seconds * len(new))
        for (name, knot), table in zip(new, tables, strict=True):
            self.contacts[name].tables[knot] = table
            self._done += 1
            self.report(self._done / max(self.usual, self._done))
        if new:
            self.seconds = (spent(self.workers) - initial) / len(new)


def _table_at(contacts: Mapping[str, MeshContact], mesh_knot: tuple[str, float]) -> SteDatabase:
    """Return the table of a mesh, by name, at a misalignment, m: one task."""
    name, misalignment = mesh_knot
    contact = contacts[name]
    return contact.bodies.table(contact.pair, contact.torques, misalignment)


def _distinct(torques: Sequence[float]) -> list[float]:
    """Return the torques in increasing order, without torques within `ALIKE` of another."""
    distinct: list[float] = []
    for torque in sorted(torques):
        if not distinct or torque > distinct[-1] * (1.0 + ALIKE):
            distinct.append(torque)
    return distinct
