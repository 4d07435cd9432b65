"""Tasks by other workers as long as there are any, then by this process: the results are the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from model_studies.workers.in_process import Workers, WorkersLost
from model_studies.workers.run_cost import RunCost

R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")


@dataclass(frozen=True)
class LocalFallback:
    """Workers that may be lost; this process does the tasks that they leave.

    `on_loss` is called once, with the reason, when they are lost. After that they get no tasks any more.
    """

    others: Workers
    on_loss: Callable[[WorkersLost], None]

    @property
    def cost(self) -> RunCost:
        """Cost of the tasks that the other workers did."""
        return self.others.cost

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield the results of the workers, and of this process once they are lost."""
        done = 0
        if not self.cost.lost:
            try:
                for result in self.others.run(function, shared, items):
                    yield result
                    done += 1
            except WorkersLost as error:
                self.cost.lost = str(error)
                self.on_loss(error)
        for item in items[done:]:
            yield function(shared, item)
