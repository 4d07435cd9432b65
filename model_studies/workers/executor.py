"""Executors of tasks and the transport of their inputs: this process, or a pool of the standard library."""

from __future__ import annotations

import hashlib
import pickle
import shutil
import tempfile
import threading
import time
import weakref
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from host import children_cpu_seconds, cpu_seconds, peak_memory

MAX_SHARED = 2
"""Number of shared inputs that a thread of a worker keeps. An input that it prepared once serves all its
tasks.
"""
_local = threading.local()
R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")
LARGE = 100_000
"""Size above which the shared input of tasks goes by a file, not with each task, bytes."""
Function = TypeVar("Function", bound=Callable[..., Any])
START_SECONDS = 10.0
"""Least predicted CPU seconds of tasks for which two new processes are started, which load program and
compiled code. Less work stays in this process.
"""
AWAKE = 0.1
"""Part of `START_SECONDS` from which workers that have done tasks get further ones: they may have to load the
inputs of other tasks.
"""


class WorkersLost(Exception):
    """Nobody is left to do the tasks of a study: a cluster without workers, a pool that broke."""


# Arguments that tasks share, pickled once.


@dataclass(frozen=True)
class Packed:
    """Something pickled, with its digest; in a file if that is given."""

    content: bytes
    digest: str
    file: Path | None = None

    @classmethod
    def of(cls, shared: object) -> Packed:
        """Pickle it."""
        content = pickle.dumps(shared, protocol=pickle.HIGHEST_PROTOCOL)
        return cls(content, hashlib.sha256(content).hexdigest())

    def in_file(self, folder: Path) -> Packed:
        """Write the shared input into a file of the folder."""
        file = folder / self.digest
        file.write_bytes(self.content)
        return Packed(b"", self.digest, file)

    def unpacked(self) -> Any:
        """Return the shared input, one object for all tasks of a thread, so that its caches last."""
        known: dict[str, Any] = _local.__dict__.setdefault("known", {})
        if self.digest not in known:
            while len(known) >= MAX_SHARED:
                known.pop(next(iter(known)))
            content = self.content if self.file is None else self.file.read_bytes()
            known[self.digest] = pickle.loads(content)
        return known[self.digest]


class _PassedFiles:
    """A folder for inputs that other processes of the machine read; it ends with the last reference to it."""

    @cached_property
    def path(self) -> Path:
        """The folder, made when first requested."""
        path = Path(tempfile.mkdtemp(prefix="lineofaction-"))
        weakref.finalize(self, shutil.rmtree, path, ignore_errors=True)
        return path


# Cost of tasks to the workers that did them.


@dataclass
class RunCost:
    """Cost of remote tasks so far, without work that was lost with its worker: nobody can tell.

    The CPU time is that of the threads that did them, or of all threads of a worker that does them in its
    main one as those of a pool do, and of the processes they started; the memory the largest of any of their
    processes; `lost` says why they were lost and the rest was done here.
    """

    tasks: int = 0
    cpu_seconds: float = 0.0
    peak_memory_bytes: int = 0
    lost: str = ""

    def since(self, before: RunCost) -> RunCost:
        """Return the cost since an earlier reading of the same cost; the peak is that of the whole time."""
        cpu_seconds = self.cpu_seconds - before.cpu_seconds
        return RunCost(self.tasks - before.tasks, cpu_seconds, self.peak_memory_bytes, self.lost)

    def add(self, done: _Done[R]) -> R:
        """Count a task, and return its result."""
        self.tasks += 1
        self.cpu_seconds += done.cpu_seconds
        self.peak_memory_bytes = max(self.peak_memory_bytes, done.peak_memory_bytes)
        return done.result


@dataclass(frozen=True)
class _Done(Generic[R]):
    """The result of one task, and its cost for the worker."""

    result: R
    cpu_seconds: float
    peak_memory_bytes: int


def do_task(function: Callable[[Any, Any], R], item: Any, packed: Packed) -> _Done[R]:
    """Do one task, on a worker."""
    begun = task_cpu_seconds()
    try:
        result = function(packed.unpacked(), item)
    except KeyboardInterrupt:  # a Ctrl-C reaches the processes of a pool, too
        raise WorkersLost("A worker was interrupted.") from None
    return _Done(result, task_cpu_seconds() - begun, peak_memory())


def task_cpu_seconds() -> float:
    """Return the CPU seconds of a task's process, or of its thread beside others, and of children."""
    alone = threading.current_thread() is threading.main_thread()
    seconds = time.process_time() if alone else time.thread_time()
    return seconds + children_cpu_seconds()


@dataclass(frozen=True)
class ByExecutor:
    """Any `concurrent.futures.Executor` of this machine; it stays the caller's to shut down.

    Its processes are spawned, not forked: compiled code and numerical libraries do not survive a fork.
    """

    executor: Executor
    cost: RunCost = field(default_factory=RunCost, compare=False)
    _folder: _PassedFiles = field(default_factory=_PassedFiles, compare=False, repr=False)
    _packed: dict[int, tuple[object, Packed]] = field(default_factory=dict, compare=False, repr=False)

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit all tasks and yield their results in order; unread results are cancelled."""
        packed = self._pack(shared)
        try:
            futures = [self.executor.submit(do_task, function, item, packed) for item in items]
        except BrokenExecutor as error:
            raise _lost(0, len(items)) from error
        return self._in_order(futures)

    def _pack(self, shared: object) -> Packed:
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
                    done = future.result()
                except BrokenExecutor as error:
                    raise _lost(count, len(futures)) from error
                yield self.cost.add(done)
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


def _lost(done: int, of: int) -> WorkersLost:
    reason = "A process of the pool ended during the run; it may have run out of memory"
    return WorkersLost(f"{reason}: {done} of {of} tasks were done.")


# The protocol of workers, and the simplest of them: this process.


class Workers(Protocol):
    """Runs independent tasks."""

    @property
    def cost(self) -> RunCost:
        """Cost of remote tasks, without the CPU time of this process."""

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield ``function(shared, item)`` of every item, in their order; `WorkersLost`: nobody is left.

        The function is one of a module; `shared`, items and results can be pickled. The same object shared by
        several runs is sent once.
        """


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


def cluster_cached(function: Function) -> Function:
    """Mark a function of tasks whose results a cluster keeps for whoever asks for the same later."""
    function.cluster_cached = True  # type: ignore[attr-defined]
    return function


# Tasks by others as long as there are any, then here: the results are the same.


@dataclass(frozen=True)
class OrHere:
    """Workers that may be lost; tasks that they leave are done in this process.

    `on_loss` is called once, with the reason, when they are lost; nobody looks for them again.
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


# Which work is divided: what costs more than the start of a process.


def _minimum(workers: Workers) -> float:
    return START_SECONDS * AWAKE if workers.cost.tasks else START_SECONDS


def divided(
    workers: Workers,
    function: Callable[[S, T], R],
    shared: S,
    items: Sequence[T],
    seconds: float | None = None,
) -> Iterator[R]:
    """Yield ``function(shared, item)`` of every item, in their order, by the workers if that pays.

    `seconds`: CPU seconds that all items are predicted to take; above `START_SECONDS`, or the part of it for
    workers that are awake, they do all of them. Else items are done here until those left would take more,
    each as long as the last. The first one tells nothing, it loads code. Raises `WorkersLost` as
    `Workers.run`, and what the function raises.
    """
    done, expected = 0, seconds or 0.0
    while len(items) - done > 1 and expected <= _minimum(workers):
        began = cpu_seconds()
        result = function(shared, items[done])
        last, done = cpu_seconds() - began, done + 1
        expected = last * (len(items) - done) if done > 1 else 0.0
        yield result
    left: Workers = workers if len(items) - done > 1 else InProcess()
    yield from left.run(function, shared, items[done:])


def pays(workers: Workers, seconds: float) -> bool:
    """Return whether work of so many predicted CPU seconds goes to workers, if it is not `divided`."""
    return not isinstance(workers, InProcess) and seconds > _minimum(workers)


def spent(workers: Workers) -> float:
    """Return the CPU seconds of this process, of its children that have ended, and of tasks by workers."""
    return cpu_seconds() + workers.cost.cpu_seconds
