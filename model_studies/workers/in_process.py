"""The protocol of workers, and the simplest of them: this process."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from model_studies.workers.run_cost import RunCost

R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")
Function = TypeVar("Function", bound=Callable[..., Any])


class WorkersLost(Exception):
    """Nobody is left to do the tasks of a study: a cluster without workers, a pool that broke."""


class Workers(Protocol):
    """Runs independent tasks."""

    @property
    def cost(self) -> RunCost:
        """Cost of remote tasks, without the CPU time of this process."""

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield ``function(shared, item)`` of every item, in their order.

        The function is one of a module; `shared`, items and results can be pickled. An object that several
        runs share is sent once. Raises `WorkersLost`: no worker is left.
        """


@dataclass(frozen=True)
class InProcess:
    """Workers that are this process: one task after the other."""

    @property
    def cost(self) -> RunCost:
        """No cost of remote tasks."""
        return RunCost()

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield results as they are computed."""
        return (function(shared, item) for item in items)


def cluster_cached(function: Function) -> Function:
    """Mark a function of tasks whose results a cluster keeps for whoever asks for the same later."""
    function.cluster_cached = True  # type: ignore[attr-defined]
    return function
