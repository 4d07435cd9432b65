"""Tasks by an executor of the standard library, such as a pool of processes of this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import dataclass, field
from typing import Any, TypeVar

from fe_contact.errors import WorkersLost
from fe_contact.workers.packed import KEPT, Packed, PassedFiles
from fe_contact.workers.run_cost import RunCost, do_task

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")

LARGE = 100_000
"""Bytes; what tasks share beyond that goes by a file and not with each of them."""


@dataclass(frozen=True)
class ByExecutor:
    """Any `concurrent.futures.Executor` of this machine; it stays the caller's to shut down.

    Attributes
    ----------
    executor : concurrent.futures.Executor
        Processes are to be spawned, not forked: compiled code and numerical libraries do not survive a fork.
    cost : RunCost
    """

    executor: Executor
    cost: RunCost = field(default_factory=RunCost, compare=False)
    _folder: PassedFiles = field(default_factory=PassedFiles, compare=False, repr=False)
    _packed: dict[int, tuple[object, Packed]] = field(default_factory=dict, compare=False, repr=False)

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit everything, yield in order; what is not yielded any more is cancelled."""
        packed = self._pack(shared)
        try:
            futures = [self.executor.submit(do_task, function, packed, item) for item in items]
        except BrokenExecutor as error:
            raise _lost(0, len(items)) from error
        return self._in_order(futures)

    def _pack(self, shared: object) -> Packed:
        """Pickle what is shared, unless that was done."""
        known = self._packed.get(id(shared))
        if known is not None:
            return known[1]
        while len(self._packed) >= KEPT:
            _, old = self._packed.pop(next(iter(self._packed)))
            if old.file is not None:
                old.file.unlink(missing_ok=True)
        packed = Packed.of(shared)
        if len(packed.content) > LARGE:
            packed = packed.in_file(self._folder.path)
        self._packed[id(shared)] = (shared, packed)
        return packed

    def _in_order(self, futures: Sequence[Future[Any]]) -> Iterator[Any]:
        """Yield the results; cancel the rest when the caller stops or a task fails."""
        try:
            for count, future in enumerate(futures):
                try:
                    done = future.result()
                except BrokenExecutor as error:
                    raise _lost(count, len(futures)) from error
                yield self.cost.add(done)
        finally:
            for future in futures:
                future.cancel()


def _lost(done: int, of: int) -> WorkersLost:
    """Say what is known of a pool that broke."""
    reason = "A process of the pool ended during the run; it may have run out of memory"
    return WorkersLost(f"{reason}: {done} of {of} tasks were done.")
