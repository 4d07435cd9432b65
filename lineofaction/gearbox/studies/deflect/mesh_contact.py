"""A mesh on its condensed gears: tables at its misalignments, and what happens on its flanks."""

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
from model_studies.workers import Workers, divided, spent

LOWEST, HIGHEST = 0.5, 1.25
"""Loads of the tables beyond those of the load cases, over the lowest and the highest of them."""

FIRST_MISALIGNMENT = 1e-6  # m: any one makes the bodies those of three dimensions

ALIKE = 1e-6
"""Of a torque: closer ones are one load of the table."""


@dataclass(frozen=True)
class MeshContact:
    """The contact of a mesh on gears whose compliance is in memory."""

    pair: ParallelAxes
    bodies: CondensedPair
    torques: FloatArray
    """On the case's pinion, N m: those of the load cases and one on either side. Shape (F,)."""
    tables: dict[float, SteDatabase] = field(default_factory=dict, repr=False)
    """By misalignment, m: those that are there so far."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Leave behind the tables, which tasks have no need of."""
        return type(self), (self.pair, self.bodies, self.torques)

    @property
    def across_face(self) -> bool:
        """Whether the load may vary over the face; a plane model has no misalignment."""
        return bool(self.bodies.checked.model.across_face)

    def table(self, misalignments: Sequence[float]) -> MeshTable:
        """Return the mesh-force table over misalignments, m, increasing."""
        tables = [self.tables[misalignment] for misalignment in misalignments]
        return joined_over_misalignment(tables).force_table()

    def solved(
        self, torque: float, misalignment: float, change: float
    ) -> tuple[SteDatabase, LoadDistribution]:
        """Return transmission error with its errors, and the flanks, at one load and alignment."""
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

        A case whose model the planner may choose, and one in three dimensions, is condensed across the face.
        """
        pair, loads = gear_pair(case), _distinct(torques)
        levels = np.array([LOWEST * loads[0], *loads, HIGHEST * loads[-1]])
        across, is_plane = database, case.accuracy.model in PLANE
        too_low = loads[-1] > database.torque[-1] * (1.0 + ALIKE)
        if not is_plane and (too_low or database.metadata.receipt["plan"]["model"] in PLANE):
            axes = TableAxes(torques=loads, misalignments=[-FIRST_MISALIGNMENT, FIRST_MISALIGNMENT])
            options = replace(analysis_options(case), receipt="minimal", positions=8)
            across = analyze(pair, axes, options, run)
        elif too_low:
            options = replace(analysis_options(case), receipt="minimal")
            across = analyze(pair, TableAxes(torques=loads), options, run)
        bodies = condensed_pair(pair, across, dict(case.effects), run.cache, compute=True)
        assert bodies is not None
        return MeshContact(pair, bodies, levels)


@dataclass
class DividedTables:
    """Lets workers compute the tables at the knots of all contacts, a table each."""

    contacts: Mapping[str, MeshContact]
    """By the names of meshes; copies share one."""
    workers: Workers
    seconds: float
    """CPU seconds of a table: predicted, then those of the last pass."""

    def complete(self, knots: Mapping[str, Sequence[float]]) -> None:
        """Compute those at misalignments by mesh, m, that are not there."""
        first = {id(contact): name for name, contact in reversed(list(self.contacts.items()))}
        wanted = (
            (first[id(self.contacts[name])], knot)
            for name, misalignments in knots.items()
            for knot in misalignments
        )
        new = [at for at in dict.fromkeys(wanted) if at[1] not in self.contacts[at[0]].tables]
        began = spent(self.workers)
        tables = divided(self.workers, _table_at, self.contacts, new, self.seconds * len(new))
        for (name, knot), table in zip(new, tables, strict=True):
            self.contacts[name].tables[knot] = table
        self.seconds = (spent(self.workers) - began) / len(new) if new else self.seconds


def _table_at(contacts: Mapping[str, MeshContact], at: tuple[str, float]) -> SteDatabase:
    """Return the table of a mesh at a misalignment, m: one task."""
    contact = contacts[at[0]]
    return contact.bodies.table(contact.pair, contact.torques, at[1])


def _distinct(torques: Sequence[float]) -> list[float]:
    """Return torques in order, those that are alike once."""
    distinct: list[float] = []
    for torque in sorted(torques):
        if not distinct or torque > distinct[-1] * (1.0 + ALIKE):
            distinct.append(torque)
    return distinct
