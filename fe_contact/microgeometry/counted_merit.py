"""The merit of designs as a search sees it: counted, ended when enough are evaluated, the best remembered."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.microgeometry.design_problem import Assessed, DesignProblem
from fe_contact.microgeometry.linear_merit import LinearMerit
from fe_contact.types import FloatArray


class BudgetUsed(Exception):
    """All designs that may be evaluated were."""


class Cancelled(Exception):
    """Somebody requested the search to end."""


class Budget:
    """Designs that one search may evaluate, of whatever cost.

    Parameters
    ----------
    total : int
    cancel : callable
        Asked before every design whether the search is to end.
    report : callable
        Called after every design with the part of all that is used.
    """

    def __init__(self, total: int, cancel: Callable[[], bool], report: Callable[[float], None]) -> None:
        self.total, self.used = total, 0
        self._cancel, self._report = cancel, report

    def take(self, most: int) -> None:
        """Take one design, if fewer than `most` were taken.

        Raises
        ------
        BudgetUsed, Cancelled
        """
        if self._cancel():
            raise Cancelled
        if self.used >= min(most, self.total):
            raise BudgetUsed
        self.used += 1

    def tell(self) -> None:
        """Report what is used."""
        self._report(self.used / self.total)


class CountedMerit:
    """Merit of a point (d,) in the unit cube.

    Parameters
    ----------
    problem : DesignProblem
    budget : Budget
    most : int
        It raises `BudgetUsed` when so many designs of the budget are used.

    Attributes
    ----------
    best : tuple of Assessed and ndarray, or None
        Of its designs, by their order; None before the first.
    count : int
        Its designs.
    least, largest : float
        Of the objectives of its designs that could be assessed, m.
    """

    def __init__(self, problem: DesignProblem, budget: Budget, most: int) -> None:
        self.best: tuple[Assessed, FloatArray] | None = None
        self.count, self.least, self.largest = 0, np.inf, -np.inf
        self._problem, self._budget, self._most = problem, budget, most

    def __call__(self, point: FloatArray) -> float:
        """Assess a design."""
        self._budget.take(self._most)
        return self._counted(self._problem.assess(point), point)

    def linearize(self, point: FloatArray) -> tuple[float, LinearMerit]:
        """Assess a design, and return its merit with what is known about it to first order."""
        self._budget.take(self._most)
        assessed, merit = self._problem.linearize(point)
        return self._counted(assessed, point), merit

    def _counted(self, assessed: Assessed, point: FloatArray) -> float:
        """Count and remember a design; return its merit."""
        self.count += 1
        if self.best is None or assessed.order < self.best[0].order:
            self.best = assessed, np.clip(point, 0.0, 1.0)
        if np.isfinite(assessed.objective):
            self.least, self.largest = (
                min(self.least, assessed.objective),
                max(self.largest, assessed.objective),
            )
        self._budget.tell()
        return assessed.merit
