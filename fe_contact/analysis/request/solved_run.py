"""The solved contact of a request, which its checks and its results read."""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.pairs.tip_edges import edge_depth
from fe_contact.analysis.request.request import Checked
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray

Solved = list[tuple[ContactProblem, ContactSolution]]
"""Problem and solution of every operating point. In a table of several base pitches, the problem and the
forces are those of the first.
"""


def edges_neglected(checked: Checked) -> bool:
    """Whether a request leaves tip edges out in the belief that they stay clear, not for a tolerance."""
    neglected = checked.request.named("corner_contact") in checked.request.neglected
    return not (checked.model.corner_contact or neglected)


@dataclass(frozen=True)
class SolvedRun:
    """A request, its plan, and problem and solution of every place."""

    checked: Checked
    plan: Plan
    places: OperatingPoints
    solved: Solved

    @property
    def edges_neglected(self) -> bool:
        """Whether tip edges were left out in the belief that they stay clear."""
        return edges_neglected(self.checked)

    @property
    def edge_depths(self) -> list[FloatArray]:
        """Largest depths of tip edges inside the mating flanks at every operating point, (L,) in m."""
        pairs = zip(self.places.places, self.solved, strict=True)
        return [edge_depth(point, *solved) for point, solved in pairs]


@dataclass(frozen=True)
class SolvedOperatingPoint(SolvedRun):
    """A run of one load set and one alignment, by its one place."""

    @property
    def contact(self) -> PairContact:
        """The pair with its compliances."""
        return self.places.places[0].contact

    @property
    def pair(self) -> ParallelAxes:
        """The pair at its center distance."""
        return self.contact.pair

    @property
    def problem(self) -> ContactProblem:
        """Contact problem of the operating point."""
        return self.solved[0][0]

    @property
    def solution(self) -> ContactSolution:
        """Solution of the operating point at all positions and loads."""
        return self.solved[0][1]
