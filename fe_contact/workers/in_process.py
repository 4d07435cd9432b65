"""The protocol of workers, and the simplest of them: this process."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from fe_contact.workers.run_cost import RunCost

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")


class Workers(Protocol):
    """Runs independent tasks."""

    @property
    def cost(self) -> RunCost:
        """Cost of remote tasks, beside the CPU time of this process."""
        ...

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield ``function(shared, item)`` of every item, in their order.

        The function is one of a module; `shared`, items and results can be pickled. The same object shared by
        several runs is sent once.

        Raises
        ------
        WorkersLost
            There is nobody left to do the tasks.
        """
        ...


@dataclass(frozen=True)
class InProcess:
    """One task after the other, here."""

    @property
    def cost(self) -> RunCost:
        """Nothing: all is done here."""
        return RunCost()

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield results as they are computed."""
        return (function(shared, item) for item in items)
