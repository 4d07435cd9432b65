"""Tasks by an executor of the standard library, such as a pool of processes of this machine."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from model_studies.workers.in_process import WorkersLost
from model_studies.workers.remote_task import MAX_SHARED, Packed, do_task
from model_studies.workers.run_cost import RunCost

R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")
LARGE = 100_000
"""Size above which the shared input of tasks goes by a file, not with each task, bytes."""


class _PassedFiles:
    """A folder for inputs that other processes of the machine read; it ends with the last reference to it."""

    @cached_property
    def path(self) -> Path:
        """The folder, made when first requested."""
        path = Path(tempfile.mkdtemp(prefix="lineofaction-"))
        weakref.finalize(self, shutil.rmtree, path, ignore_errors=True)
        return path


@dataclass(frozen=True)
class ByExecutor:
    """Any `concurrent.futures.Executor` of this machine; it stays the caller's to shut down.

    Its processes are spawned, not forked: compiled code and numerical libraries do not survive a fork.
    """

    executor: Executor
    cost: RunCost = field(default_factory=RunCost, compare=False)
    _folder: _PassedFiles = field(default_factory=_PassedFiles, compare=False, repr=False)
    _packed: dict[int, tuple[object, Packed]] = field(default_factory=dict, compare=False, repr=False)
    """Shared inputs and their pickles, by `id`; holding an input keeps its `id` from being used again."""

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit all tasks and yield their results in order; unread results are cancelled."""
        packed = self._pack(shared)
        try:
            futures = [self.executor.submit(do_task, function, item, packed) for item in items]
        except BrokenExecutor as error:
            raise _lost(0, len(items)) from error
        return self._in_order(futures)

    def _pack(self, shared: object) -> Packed:
        """Pickle the shared input of tasks, once for successive runs with the same object."""
        known = self._packed.get(id(shared))
        if known is not None:
            return known[1]
        while len(self._packed) >= MAX_SHARED:
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
                    task = future.result()
                except BrokenExecutor as error:
                    raise _lost(count, len(futures)) from error
                self.cost.add(task)
                yield task.result
        finally:
            for future in futures:
                future.cancel()


@contextmanager
def local_processes(count: int) -> Iterator[ByExecutor]:
    """Provide new processes of this machine; if the block fails they end at once, whatever they do."""
    from concurrent.futures import ProcessPoolExecutor  # noqa: PLC0415 (start-up time)
    from multiprocessing import get_context  # noqa: PLC0415

    # spawn: compiled code and numerical libraries do not survive a fork
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as executor:
        try:
            yield ByExecutor(executor)
        except BaseException:
            for process in list((executor._processes or {}).values()):
                process.kill()
            raise


def _lost(done: int, total: int) -> WorkersLost:
    reason = "A process of the pool ended during the run; it may have run out of memory"
    return WorkersLost(f"{reason}: {done} of {total} tasks were done.")
