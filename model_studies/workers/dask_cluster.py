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
"""First characters of the names of stored results; the time and the key of the task follow."""
CONNECT_S = 10.0
"""Longest wait for the answer of a scheduler, s."""


@dataclass(frozen=True)
class ByDask:
    """A Dask cluster: tasks of workers that die are run again by others.

    The caller closes the client. A run ends with `WorkersLost` after `patience` seconds without any worker.
    """

    client: Client
    patience: float = PATIENCE_S
    cost: RunCost = field(default_factory=RunCost, compare=False)
    _sent: dict[int, tuple[object, str, Any]] = field(default_factory=dict, compare=False, repr=False)

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Submit all tasks and yield their results in order; results that nobody reads are released.

        A task has a name by its content: equal tasks of several callers at the same time are done once. The
        results of a `cluster_cached` function stay in the cluster for later callers.
        """
        import dask  # noqa: PLC0415 (an extra)

        if self._gone:
            raise WorkersLost(f"The scheduler {self._address} is gone: 0 of {len(items)} tasks were done.")
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1TB"}):
            digest, packed = self._send(shared)
            name = f"{function.__module__}.{function.__qualname__}"
            keys = [f"{name}-{digest}-{Packed.of(item).digest}" for item in items]
            # all tasks in one graph: a submission for each costs the scheduler as much as a task
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
        _, digest, future = known
        return digest, future

    def _in_order(self, futures: Sequence[Any], *, keep: bool) -> Iterator[Any]:
        """Yield the results; release the others when the caller stops or a task fails."""
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
        """Return names of stored results, the oldest first, and the keys of their tasks."""
        names: tuple[str, ...] = ()
        with suppress(Exception):  # where the scheduler is gone, the tasks raise it
            names = self.client.list_datasets()
        return [(name, name.partition(" ")[2]) for name in sorted(names) if name.startswith(_PREFIX)]

    def _publish(self, futures: Mapping[str, Any]) -> None:
        """Store results in the cluster; workers write to disk what exceeds their memory."""
        published, now = self._published(), f"{_PREFIX}{time.time():.3f}"
        new: dict[Any, Any] = {
            f"{now} {key}": futures[key] for key in futures.keys() - {key for _, key in published}
        }
        oldest_first: list[Any] = [name for name, _ in published]
        excess = max(0, len(oldest_first) + len(new) - MAX_RESULTS)
        with suppress(Exception):  # the caller has all results; without a store they are computed again later
            self.client.publish_dataset(new)
            self.client.unpublish_dataset(oldest_first[:excess])

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
            except TimeoutError:  # raised by the task itself, or its result did not arrive in time
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
        """Return the result of the first future and those of the next ones that are ready, by one message."""
        ready = list(takewhile(lambda future: future.status == "finished", futures)) or [futures[0]]
        gather = partial(self.client.gather, asynchronous=True)
        results: list[Any] = self.client.sync(gather, ready, callback_timeout=self.patience)
        return results

    def _ended(self, future: Any) -> bool:
        """Whether a task ended within one interval of waiting."""
        from distributed import wait  # noqa: PLC0415 (an extra)

        try:
            with self.client.as_current():
                wait([future], timeout=_LOOK_S)
        except TimeoutError:
            return False
        return True

    def _workers(self) -> bool:
        """Whether the cluster has a worker; False where the scheduler does not answer."""
        try:
            return bool(self.client.nthreads())
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

    `scheduler`: its address, ``tcp://host:port``, or the file into which it wrote its address, as schedulers
    of batch systems do (``dask scheduler --scheduler-file``). All workers must have this program in this
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

    security = Security().get_connection_args("client")
    if address.startswith(("tls://", "wss://")) and security["ssl_context"] is None:
        files = "CA_FILE, DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT and ...CLIENT__KEY"
        raise OSError(f"it wants certificates: name their files in DASK_DISTRIBUTED__COMM__TLS__{files}")
    if security["require_encryption"] and not address.startswith(("tls://", "wss://")):
        raise OSError("DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION is set: its address begins with tls://")
    options: dict[str, Any] = {"asynchronous": asynchronous, "timeout": CONNECT_S, "set_as_default": False}
    return Client(address, **options)


def _address_in(file: Path) -> str:
    content = json.loads(file.read_text("utf-8"))
    if not (isinstance(content, dict) and isinstance(content.get("address"), str)):
        raise ValueError("the file is not one that a scheduler left")
    return str(content["address"])
