"""Mesh load and shaft deflection in agreement: tables at the misalignments at which the meshes run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dynamics.deflection import Deflection, deflect
from dynamics.meshes import MeshTable
from dynamics.scene import Scene
from dynamics.settings.load_case import LoadCase
from fe_contact.analysis.analyze import ste_database
from fe_contact.analysis.flanks.load_distribution import LoadDistribution, load_distribution
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.ste.database import joined_over_misalignment
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.case import PLANE, analysis_options, gear_pair
from lineofaction.gearbox.schemas import Case
from model_studies.workers import InProcess, Workers, divided, spent

# A mesh on its condensed gears: tables at the alignments that are met, and what happens on its flanks.


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
            across = ste_database(pair, axes, options, run)
        elif too_low:
            options = replace(analysis_options(case), receipt="minimal")
            across = ste_database(pair, TableAxes(torques=loads), options, run)
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
        wanted = ((first[id(self.contacts[name])], knot) for name, own in knots.items() for knot in own)
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
    torques_apart: list[float] = []
    for torque in sorted(torques):
        if not torques_apart or torque > torques_apart[-1] * (1.0 + ALIKE):
            torques_apart.append(torque)
    return torques_apart


TOLERANCE = 1e-6
"""Change of every misalignment by the last pass, of its size or of `SMALL`."""
SMALL = 1e-6  # m
PASSES = 6
MARGIN, LEAST_MARGIN = 0.5, 2e-6
"""Of the first knots beyond the misalignments without contact: a part of their range, at least in m."""
CLOSEST = 2e-8
"""Least distance of knots, m: a closer one takes the place of the one before."""


@dataclass(frozen=True)
class Agreement:
    """The deflection with the tables that belong to it.

    `change`: largest change of a misalignment by the last pass, over its size or `SMALL`.
    """

    deflection: Deflection
    passes: int
    change: float

    @property
    def reached(self) -> bool:
        """Whether bodies and meshes agree."""
        return self.deflection.converged and self.change <= TOLERANCE


def in_agreement(
    scene: Scene,
    cases: Sequence[LoadCase],
    positions: int,
    contacts: Mapping[str, MeshContact],
    first: Deflection,
    complete: Callable[[Mapping[str, Sequence[float]]], object] = lambda _knots: None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> Agreement:
    """Deflect the scene until the misalignments are those of the tables.

    A table is exact at its knots, and each pass puts a knot where the meshes ran in the last one. Between
    knots bodies and mesh are in balance by Newton's method, so that soft shafts cost no more passes.

    Parameters
    ----------
    contacts : mapping
        Of the meshes whose load may vary over the face, by name.
    first : Deflection
        On the tables of the scene.
    complete : callable
        Called with the knots by mesh, m, before their tables are asked for.
    workers : Workers
        As of `deflect`.
    """
    if not contacts:
        return Agreement(first, 1, 0.0)
    stated = {mesh.name: mesh.misalignment for mesh in scene.meshes}
    knots = {name: _first_knots(_misalignments(first, name), stated[name]) for name in contacts}
    last, deflection, change, passes = first, first, float("inf"), 0
    while passes < PASSES:
        passes += 1
        complete(knots)
        tables = {name: contact.table(knots[name]) for name, contact in contacts.items()}
        meshes = tuple(replace(mesh, table=tables.get(mesh.name, mesh.table)) for mesh in scene.meshes)
        deflection = deflect(replace(scene, meshes=meshes), cases, positions, workers=workers)
        change = _change(last, deflection, contacts)
        if change <= TOLERANCE or not deflection.converged:
            break
        knots = {name: _with_knots(own, _misalignments(deflection, name)) for name, own in knots.items()}
        last = deflection
    return Agreement(deflection, passes, change)


def _misalignments(deflection: Deflection, mesh: str) -> list[float]:
    """Return the misalignments of a mesh over the load cases, m."""
    return [own.misalignment for case in deflection.cases for own in case.meshes if own.name == mesh]


def _first_knots(misalignments: Sequence[float], stated: float) -> list[float]:
    """Return knots from the misalignments without the moment of uneven loads, m, increasing.

    They reach to the misalignment that the scene states, at which its rest begins.
    """
    low, high = min(misalignments), max(misalignments)
    margin = max(MARGIN * (high - low), MARGIN * max(abs(low), abs(high)), LEAST_MARGIN)
    return _with_knots([min(low - margin, stated), max(high + margin, stated)], misalignments, 0.1 * margin)


def _with_knots(knots: Sequence[float], further: Sequence[float], closest: float = CLOSEST) -> list[float]:
    """Return knots with further ones, increasing; of closer ones than `closest` the later stays."""
    kept = list(knots)
    for knot in further:
        kept = [*(own for own in kept if abs(own - knot) >= closest), knot]
    return sorted(kept)


def _change(last: Deflection, deflection: Deflection, contacts: Mapping[str, MeshContact]) -> float:
    """Return the largest change of a misalignment, over its size or `SMALL`."""
    changes = [0.0]
    for name in contacts:
        before, now = (np.array(_misalignments(each, name)) for each in (last, deflection))
        changes.append(float(np.max(np.abs(now - before) / np.maximum(np.abs(now), SMALL))))
    return max(changes)
