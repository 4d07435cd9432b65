"""Who does independent tasks: this process, an executor, or a Dask cluster; results do not depend on which.

A task is a plain function of something large that all tasks share and of one small item. Items are fixed by
the caller, whatever the number of workers, and results come in the order of the items.
"""

from __future__ import annotations

import hashlib
import pickle
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from fe_contact.errors import InputError

if TYPE_CHECKING:
    from distributed import Client

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")

KEPT = 2
"""Shared things that a thread of a worker keeps: what it prepared of one serves all its tasks."""
_local = threading.local()


class Workers(Protocol):
    """Runs independent tasks."""

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield ``function(shared, item)`` of every item, in their order.

        The function is one of a module; `shared`, items and results can be pickled.
        """
        ...


@dataclass(frozen=True)
class InProcess:
    """One task after the other, here."""

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield results as they are computed."""
        return (function(shared, item) for item in items)


@dataclass(frozen=True)
class ByExecutor:
    """Any `concurrent.futures.Executor`, such as a pool of processes; it stays the caller's to shut down."""

    executor: Executor

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit everything, yield in order; what is not yielded any more is cancelled."""
        packed = Packed.of(shared)
        futures = [self.executor.submit(_call, function, packed, item) for item in items]
        return _in_order(futures)


@dataclass(frozen=True)
class ByDask:
    """A Dask cluster: tasks of workers that die are run again by others.

    Attributes
    ----------
    client : distributed.Client
        Stays the caller's to close.
    """

    client: Client

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit everything, yield in order; what is not yielded any more is cancelled."""
        import dask  # noqa: PLC0415 (an extra)

        # a task of its own, not scattered data: the scheduler makes it again where its worker died
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1TB"}):
            packed = self.client.submit(_itself, Packed.of(shared), pure=False)
            futures = [self.client.submit(_call, function, packed, item, pure=False) for item in items]
        return _in_order(futures)


@dataclass(frozen=True)
class Packed:
    """Something pickled once, with its digest."""

    content: bytes
    digest: str

    @classmethod
    def of(cls, shared: object) -> Packed:
        """Pickle it."""
        content = pickle.dumps(shared, protocol=pickle.HIGHEST_PROTOCOL)
        return cls(content, hashlib.sha256(content).hexdigest())

    def unpacked(self) -> Any:
        """Return it; the same object for all tasks of a thread, so that what it keeps is kept."""
        known: dict[str, Any] = _local.__dict__.setdefault("known", {})
        if self.digest not in known:
            while len(known) >= KEPT:
                known.pop(next(iter(known)))
            known[self.digest] = pickle.loads(self.content)
        return known[self.digest]


def _call(function: Callable[[Any, T], R], packed: Packed, item: T) -> R:
    """Do one task, on a worker."""
    return function(packed.unpacked(), item)


def _itself(packed: Packed) -> Packed:
    """Return what was sent, on a worker."""
    return packed


def _in_order(futures: Sequence[Any]) -> Iterator[Any]:
    """Yield the results; cancel the rest when the caller stops or a task fails."""
    try:
        for future in futures:
            yield future.result()
    finally:
        for future in futures:
            future.cancel()


def dask_workers(scheduler: str) -> ByDask:
    """Connect to a Dask scheduler.

    Parameters
    ----------
    scheduler : str
        Its address, ``tcp://host:port``; all its workers have this program installed, in this version.

    Raises
    ------
    InputError
        Dask is not installed, or no scheduler answers there.
    """
    try:
        from distributed import Client  # noqa: PLC0415 (an extra)
    except ImportError:
        advice = "pip install 'lineofaction[dask]'"
        raise InputError("dask", scheduler, "left out without the extra dask", advice) from None
    try:
        client = Client(scheduler, timeout=10.0, set_as_default=False)  # type: ignore[no-untyped-call]
        return ByDask(client)
    except (OSError, ValueError) as error:
        bound = "the address of a running Dask scheduler, such as tcp://host:8786"
        raise InputError("dask", scheduler, bound, f"{error}.") from None
