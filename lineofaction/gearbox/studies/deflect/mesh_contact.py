"""A mesh on its condensed gears: tables at the alignments that are met, and what happens on its flanks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from dynamics.meshes import MeshTable
from fe_contact.analysis import CondensedPair, condensed_pair, load_distribution, ste_database
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.ste.database import joined_over_misalignment
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.case import analysis_options, gear_pair
from lineofaction.gearbox.schemas import Case
from model_studies import Progress

LOWEST, HIGHEST = 0.5, 1.25
"""Loads of the tables beyond those of the load cases, over the lowest and the highest of them."""
FIRST_MISALIGNMENT = 1e-6  # m: any one makes the bodies those of three dimensions
ALIKE = 1e-6
"""Of a torque: closer ones are one load of the table."""
PLANE = ("plane_strain", "plane_stress")


@dataclass(frozen=True)
class MeshContact:
    """The contact of a mesh on gears whose compliance is in memory.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    bodies : CondensedPair
    torques : (F,) array
        On the case's pinion, N m: those of the load cases and one on either side.
    """

    pair: ParallelAxes
    bodies: CondensedPair
    torques: FloatArray
    _tables: dict[float, SteDatabase] = field(default_factory=dict, repr=False)

    @property
    def across_face(self) -> bool:
        """Whether the load may vary over the face; a plane model has no misalignment."""
        return bool(self.bodies.checked.model.across_face)

    def table(self, misalignments: Sequence[float]) -> MeshTable:
        """Return the mesh-force table over misalignments, m, increasing."""
        tables = [self._at(misalignment) for misalignment in misalignments]
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

    def _at(self, misalignment: float) -> SteDatabase:
        """Return the table of one misalignment; it is kept."""
        if misalignment not in self._tables:
            self._tables[misalignment] = self.bodies.table(self.pair, self.torques, misalignment)
        return self._tables[misalignment]


def mesh_contact(
    case: Case, database: SteDatabase, torques: Sequence[float], home: Path, report: Progress
) -> MeshContact:
    """Return the contact of a case for loads on its pinion, N m.

    A case whose model the planner may choose, and one in three dimensions, is condensed across the face.
    """
    pair, cache = gear_pair(case), home / "compliance"
    loads = _distinct(torques)
    levels = np.array([LOWEST * loads[0], *loads, HIGHEST * loads[-1]])
    across = database
    too_low = loads[-1] > database.torque[-1] * (1.0 + ALIKE)
    if case.accuracy.model not in PLANE and (too_low or not _across_face(database)):
        axes = TableAxes(torques=loads, misalignments=[-FIRST_MISALIGNMENT, FIRST_MISALIGNMENT])
        options = replace(analysis_options(case), receipt="minimal", positions=8)
        across = ste_database(pair, axes, options, Run(cache=cache, progress=report))
    elif too_low:
        options = replace(analysis_options(case), receipt="minimal")
        across = ste_database(pair, TableAxes(torques=loads), options, Run(cache=cache, progress=report))
    bodies = condensed_pair(pair, across, dict(case.effects), cache, compute=True)
    assert bodies is not None
    return MeshContact(pair, bodies, levels)


def _across_face(database: SteDatabase) -> bool:
    """Whether a table is of three dimensions."""
    plan: Mapping[str, object] = database.metadata.receipt["plan"]
    return plan["model"] not in PLANE


def _distinct(torques: Sequence[float]) -> list[float]:
    """Return torques in order, those that are alike once."""
    torques_apart: list[float] = []
    for torque in sorted(torques):
        if not torques_apart or torque > torques_apart[-1] * (1.0 + ALIKE):
            torques_apart.append(torque)
    return torques_apart
