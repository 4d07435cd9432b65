"""The contact of a request as it was solved: what its checks and its results read."""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.analysis.pairs.pair_contact import OperatingPoints, PairContact
from fe_contact.analysis.request.request import Checked
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.plan import Plan


@dataclass(frozen=True)
class SolvedRun:
    """A request, its plan, and problem and solution of every place."""

    checked: Checked
    plan: Plan
    places: OperatingPoints
    solved: list[tuple[ContactProblem, ContactSolution]]


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
        """Its contact problem."""
        return self.solved[0][0]

    @property
    def solution(self) -> ContactSolution:
        """Its solution at all positions and loads."""
        return self.solved[0][1]
