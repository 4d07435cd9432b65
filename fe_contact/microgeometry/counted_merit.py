"""The merit of designs as a search sees it: counted, remembered, and ended with the budget."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from fe_contact.microgeometry.design_problem import SLACK, USUAL_DESIGNS, Assessed, Merit, SearchProblem
from fe_contact.types import FloatArray
from model_studies.workers import InProcess, Workers, divided, pays, spent

Design = tuple[Assessed, FloatArray]
TAIL = 0.1
"""Part of the work done that is taken to be left where a search goes on beyond its usual cost."""


class BudgetUsed(Exception):
    """All designs that may be evaluated were."""


class Cancelled(Exception):
    """Somebody requested the search to end."""


class Budget:
    """Designs that one search may evaluate, of whatever cost.

    Before every design `cancel` is called; after it the part of the work done is reported: the cost of all
    designs so far over the `usual` cost of the whole search, in designs at all positions.
    """

    def __init__(
        self,
        total: int,
        cancel: Callable[[], bool],
        report: Callable[[float], None],
        usual: float = math.inf,
    ) -> None:
        self.total, self.used = total, 0
        self.cancelled, self._report = cancel, report
        self._usual, self._paid = min(usual, float(total)), 0.0

    def take(self, maximum: int) -> None:
        """Take one design, if fewer than `maximum` were taken; raises `BudgetUsed` or `Cancelled`."""
        if self.cancelled():
            raise Cancelled
        if self.used >= min(maximum, self.total):
            raise BudgetUsed
        self.used += 1

    def tell(self, price: float) -> None:
        """Report the part of the work done after a design of a price, in designs at all positions."""
        self._paid += price
        tail = TAIL * self._paid if self.used < self.total else 0.0
        self._report(self._paid / (self._paid + max(self._usual - self._paid, tail)))


class CountedMerit:
    """Merit of a point (d,) in the unit cube.

    Parameters
    ----------
    maximum : int
        Number of used designs of the budget at which it raises `BudgetUsed`.
    workers : Workers
        Workers that assess independent designs, and follow independent walks.
    price : float
        Cost of a design, in designs at all positions.

    Attributes
    ----------
    designs : list of (Assessed, ndarray)
        Evaluated designs in their order.
    ends : list of (Assessed, ndarray)
        Designs at which walks ended.
    """

    def __init__(
        self,
        problem: SearchProblem,
        budget: Budget,
        maximum: int,
        workers: Workers = InProcess(),  # noqa: B008 (frozen)
        price: float = 1.0,
    ) -> None:
        self.problem, self.workers, self._seconds, self._price = problem, workers, 0.0, price
        self.designs: list[Design] = []
        self.ends: list[Design] = []
        self._budget, self._maximum = budget, maximum

    def __call__(self, point: FloatArray) -> float:
        """Assess a design."""
        self._budget.take(self._maximum)
        return self._counted(self.problem.assess(point), point)

    def linearize(self, point: FloatArray) -> tuple[float, Merit]:
        """Assess a design, and return its merit to first order."""
        self._budget.take(self._maximum)
        began = spent(self.workers)
        assessed, merit = self.problem.linearize(point, self.workers if self.divides else InProcess())
        self._seconds = spent(self.workers) - began
        return self._counted(assessed, point), merit

    @property
    def divides(self) -> bool:
        """Whether it pays to give workers parts of walks, by the last design that was linearized."""
        return pays(self.workers, self._seconds * USUAL_DESIGNS)

    def assessed_in_turn(self, points: Sequence[FloatArray]) -> Iterator[float]:
        """Assess designs, as far as the budget reaches; those in the memory cost nothing, and stay here."""
        results = divided(self.workers, _assess, self.problem, points[: self.left])
        for point in points:
            self._budget.take(self._maximum)
            yield self._counted(next(results), point)

    @property
    def left(self) -> int:
        """Designs that may still be evaluated."""
        return max(0, min(self._maximum, self._budget.total) - self._budget.used)

    def replay(self, designs: Iterable[Design]) -> None:
        """Count designs that a worker assessed."""
        for assessed, point in designs:
            self._budget.take(self._maximum)
            self._counted(assessed, point)

    def _counted(self, assessed: Assessed, point: FloatArray) -> float:
        """Count and remember a design; return its merit."""
        self.designs.append((assessed, np.clip(point, 0.0, 1.0)))
        self.problem.keep(point, assessed)
        self._budget.tell(self._price)
        return assessed.merit

    def end(self, point: FloatArray) -> None:
        """Remember the design at which a walk ended."""
        self.ends.append(
            next(design for design in reversed(self.designs) if np.array_equal(design[1], point))
        )

    @property
    def levels(self) -> tuple[float, ...]:
        """Objectives at which walks ended that exceed the limits by hardly more than the best of them."""
        minimum = min((assessed.violation for assessed, _ in self.ends), default=0.0) + SLACK
        return tuple(assessed.objective for assessed, _ in self.ends if assessed.violation <= minimum)

    @property
    def best(self) -> Design | None:
        """The first of its designs by their order; None before any."""
        return min(self.designs, key=lambda design: design[0].order, default=None)

    @property
    def spread(self) -> float:
        """Largest less least objective of its designs that could be assessed."""
        known = [assessed.objective for assessed, _ in self.designs if math.isfinite(assessed.objective)]
        return max(known) - min(known) if known else 0.0


def _assess(problem: SearchProblem, point: FloatArray) -> Assessed:
    """Assess a design: one task."""
    return problem.assess(point)
