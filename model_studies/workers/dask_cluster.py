"""Tasks by a Dask cluster."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from host.extras import require
from model_studies.workers.in_process import WorkersLost
from model_studies.workers.remote_task import MAX_SHARED, Packed, do_task
from model_studies.workers.run_cost import RunCost

if TYPE_CHECKING:
    from distributed import Client

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")

PATIENCE_S = 60.0
"""Longest time of a cluster without any worker, s. Workers of a nanny come back within seconds."""
_LOOK_S = 1.0
"""Interval at which the workers of a cluster are counted, s."""
_AT_ONCE = 256
"""Largest number of results that one message fetches."""
MAX_RESULTS = 64
"""Number of results of `cluster_cached` tasks that stay in a cluster. A gear over its face has up to 100 MB.
"""
_PREFIX = "kept-"
CONNECT_S = 10.0
"""Longest wait for the answer of a scheduler, s."""


@dataclass(frozen=True)
class ByDask:
    """A Dask cluster: tasks of workers that die are run again by others.

    The client stays the caller's to close; after `patience` seconds without any worker the run is given up.
    """

    client: Client
    patience: float = PATIENCE_S
    cost: RunCost = field(default_factory=RunCost, compare=False)
    _sent: dict[int, tuple[object, str, Any]] = field(default_factory=dict, compare=False, repr=False)

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit all tasks and yield their results in order; unread results are left.

        A task is named by its content: what several callers want at the same time is done once, and what is
        `cluster_cached` is done once while the cluster lasts.
        """
        import dask  # noqa: PLC0415 (an extra)

        if self._gone:
            raise WorkersLost(f"The scheduler {self._address} is gone: 0 of {len(items)} tasks were done.")
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1TB"}):
            digest, packed = self._send(shared)
            name = f"{function.__module__}.{function.__qualname__}"
            keys = [f"{name}-{digest}-{Packed.of(item).digest}" for item in items]
            # one graph: a submission each costs the scheduler as much as the task
            futures = self.client.map(partial(do_task, function), items, packed=packed, key=keys)
        return self._in_order(futures, keep=getattr(function, "cluster_cached", False))

    def _send(self, shared: object) -> tuple[str, Any]:
        """Return digest and future of the shared input, which is sent unless it was sent before."""
        known = self._sent.get(id(shared))
        if known is None or known[2].status == "cancelled":
            self._sent.pop(id(shared), None)
            while len(self._sent) >= MAX_SHARED:
                self._sent.pop(next(iter(self._sent)))
            packed = Packed.of(shared)
            # a task of its own, not scattered data: the scheduler makes it again where its worker died
            future = self.client.submit(_itself, packed, key=f"shared-{packed.digest}")
            known = self._sent[id(shared)] = (shared, packed.digest, future)
        return known[1:]

    def _in_order(self, futures: Sequence[Any], *, keep: bool) -> Iterator[Any]:
        """Yield the results; let go of the rest when the caller stops or a task fails."""
        count = 0
        try:
            earlier_keys = {key for _, key in self._published()} if keep else set()
            while count < len(futures):
                for task in self._results(futures, count):
                    if futures[count].key not in earlier_keys:  # a stored result costs nothing again
                        self.cost.add(task)
                    yield task.result
                    count += 1
            if keep:
                self._publish({future.key: future for future in futures})
        finally:
            for future in () if self._gone else futures:
                future.release()

    def _published(self) -> list[tuple[str, str]]:
        """Return names of kept results, the oldest first, and the keys of their tasks."""
        names: tuple[str, ...] = ()
        with suppress(Exception):  # a scheduler that is gone ends the tasks, which say so
            names = self.client.list_datasets()  # type: ignore[no-untyped-call]
        return [(name, name.partition(" ")[2]) for name in sorted(names) if name.startswith(_PREFIX)]

    def _publish(self, futures: Mapping[str, Any]) -> None:
        """Leave results with the workers, which write to disk what their memory has no room for."""
        published, now = self._published(), f"{_PREFIX}{time.time():.3f}"
        new: dict[Any, Any] = {
            f"{now} {key}": futures[key] for key in futures.keys() - {key for _, key in published}
        }
        older: list[Any] = [name for name, _ in published]
        with suppress(Exception):  # all results are here: who asks for them later makes them again
            self.client.publish_dataset(new)
            self.client.unpublish_dataset(older[: max(0, len(older) + len(new) - MAX_RESULTS)])

    def _results(self, futures: Sequence[Any], first: int) -> list[Any]:
        """Wait for a result as long as a worker exists; return it with those ready after it."""
        from asyncio import CancelledError as Cancelled  # noqa: PLC0415 (start-up time)

        from distributed import KilledWorker  # noqa: PLC0415 (an extra)

        so_far = f"{first} of {len(futures)} tasks were done"
        alone_since = None
        while True:
            try:
                if self._ended(futures[first]):
                    return self._fetched(futures[first : first + _AT_ONCE])
            except TimeoutError:  # of the task itself, or its result did not come over in time
                if futures[first].status == "error":
                    raise
            except KilledWorker:
                ended = "A task ended every worker that tried it; they may have run out of memory"
                raise WorkersLost(f"{ended}: {so_far}.") from None
            except (CancelledError, Cancelled):
                raise WorkersLost(f"The scheduler {self._address} is gone: {so_far}.") from None
            alone_since = None if self._workers() else alone_since or time.monotonic()
            if alone_since is not None and time.monotonic() - alone_since > self.patience:
                alone = f"The cluster of {self._address} had no worker for {self.patience:g} s"
                raise WorkersLost(f"{alone}: {so_far}. Start workers there, and run it again.")

    def _fetched(self, futures: Sequence[Any]) -> list[Any]:
        """Return the result of the first, and of those behind it that are ready, by one message."""
        ready = list(takewhile(lambda future: future.status == "finished", futures)) or [futures[0]]
        gather = partial(self.client.gather, asynchronous=True)
        results: list[Any] = self.client.sync(gather, ready, callback_timeout=self.patience)  # type: ignore[no-untyped-call]
        return results

    def _ended(self, future: Any) -> bool:
        """Whether a task ended within one interval of waiting."""
        from distributed import wait  # noqa: PLC0415 (an extra)

        try:
            with self.client.as_current():
                wait([future], timeout=_LOOK_S)  # type: ignore[no-untyped-call]
        except TimeoutError:
            return False
        return True

    def _workers(self) -> bool:
        """Whether the scheduler has any; one that does not answer ends the futures by itself."""
        try:
            return bool(self.client.nthreads())  # type: ignore[no-untyped-call]
        except (OSError, TimeoutError):
            return False

    @property
    def _gone(self) -> bool:
        return str(self.client.status) in ("closing", "closed")

    @property
    def _address(self) -> str:
        return str(self.client.scheduler.address) if self.client.scheduler else "the cluster"


def _itself(packed: Packed) -> Packed:
    return packed


def dask_workers(scheduler: str) -> ByDask:
    """Connect to a Dask scheduler.

    `scheduler`: its address, ``tcp://host:port``, or the file in which it left it, as schedulers of batch
    systems do (``dask scheduler --scheduler-file``); all its workers have this program installed, in this
    version. Raises `MissingExtra`: Dask is not installed; `WorkersLost`: no scheduler answers there.
    """
    try:
        address = scheduler if "://" in scheduler else _address_in(Path(scheduler))
        return ByDask(connection(address))
    except (OSError, ValueError) as error:
        raise WorkersLost(f"No Dask scheduler answers at {scheduler}: {error}.") from None


def connection(address: str, *, asynchronous: bool = False) -> Client:
    """Return a client of a scheduler, connected unless it is asynchronous.

    Raises
    ------
    MissingExtra
        Dask is not installed.
    OSError
        Nobody answers there in `CONNECT_S`; or certificates are missing, or do not fit.
    """
    require("dask")
    from distributed import Client, Security  # noqa: PLC0415 (an extra)

    mine = Security().get_connection_args("client")  # type: ignore[no-untyped-call]
    if address.startswith(("tls://", "wss://")) and mine["ssl_context"] is None:
        files = "CA_FILE, DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT and ...CLIENT__KEY"
        raise OSError(f"it wants certificates: name their files in DASK_DISTRIBUTED__COMM__TLS__{files}")
    if mine["require_encryption"] and not address.startswith(("tls://", "wss://")):
        raise OSError("DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION is set: its address begins with tls://")
    options: dict[str, Any] = {"asynchronous": asynchronous, "timeout": CONNECT_S, "set_as_default": False}
    return Client(address, **options)  # type: ignore[no-untyped-call]


def _address_in(file: Path) -> str:
    content = json.loads(file.read_text("utf-8"))
    if not (isinstance(content, dict) and isinstance(content.get("address"), str)):
        raise ValueError("the file is not one that a scheduler left")
    return str(content["address"])
