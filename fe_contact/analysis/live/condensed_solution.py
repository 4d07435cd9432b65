"""Contact of other flanks on condensed bodies: what a table is made of, and results on the flanks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.tables.position_nodes import PositionNodes
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class CondensedSolution:
    """One alignment at all positions and loads of a question.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
        At its center distance.
    checked : Checked
    problem : ContactProblem
    solution : ContactSolution
    """

    pair: ParallelAxes
    checked: Checked
    problem: ContactProblem
    solution: ContactSolution

    @classmethod
    def of(
        cls, checked: Checked, points: OperatingPoints, nodes: PositionNodes, load: FloatArray
    ) -> CondensedSolution:
        """Solve the one operating point at all positions of a period, under forces (L,) in N."""
        point = points.places[0]
        problem, solution = point.solve_pitches(nodes.position, load, np.arange(points.period))
        return cls(point.contact.pair, checked, problem, solution)
