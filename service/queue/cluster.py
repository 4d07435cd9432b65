"""Jobs as tasks of a Dask scheduler, one task for each job.

A thread with its own event loop talks to Dask. It compares the tasks that the server wants with those of its
connection and submits the others, under the names of the tasks; a name that Dask knows already gives the
present task. A lost scheduler and a restarted server are therefore the same case. Each task is published as
a dataset of its name, so that Dask keeps it when the server is gone.

Three schedulers meet here: that of Dask; that of this service, which owns a `Cluster` and its `Task`s; and
the event loop of the thread.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import structlog

from fe_contact.cache_reads import CacheReads
from lineofaction.gearbox.problems import BadInput
from model_studies.workers import dask_cluster
from service.worker.order import Outcome, WorkOrder
from service.worker.task import Done, do_job, program
from service.worker.usage import Usage, no_space
from service.worker.worker import Step

if TYPE_CHECKING:
    from distributed import Client

_LOOK_S = 1.0
"""Seconds between two checks of the connection and of the workers."""
_STOPPING_S = 2.0
"""Seconds for which a stop waits for a connection that is being made."""
logger = structlog.get_logger(__name__)


class Task:
    """A job that was handed to Dask, with the methods of `service.worker.worker.Worker` of this machine."""

    channel: int | None = None
    """File descriptor that wakes the service's scheduler; None: `Cluster` calls its `notify` instead."""

    def __init__(self, name: str, order: WorkOrder, log: Path, drop: Callable[[str], None]) -> None:
        self.name, self.order, self._log, self._drop = name, order, log, drop
        self.usage: Usage | None = None
        self.compliance_reads, self.warnings = CacheReads(), list[str]()
        self._begin = ""  # name of the run of the task that a worker reported; empty: none yet
        self._started: float | None = None
        self._spent: float | None = None
        self._steps: deque[Step] = deque()
        self._outcome: Outcome | None = None

    @property
    def log_fields(self) -> dict[str, Any]:
        """The fields that name the task in the log."""
        return {"task": self.name}

    @property
    def begun(self) -> bool:
        """Whether a worker has reported that it began the task."""
        return self._begin != ""

    @property
    def age(self) -> float:
        """Seconds since a worker began it; 0 before."""
        return 0.0 if self._started is None else time.monotonic() - self._started

    def spent(self) -> float | None:
        """Return the CPU seconds of its child so far, as last reported."""
        return self._spent

    def hear(self, event: Mapping[str, Any]) -> None:
        """Take the report of a worker.

        A report of another run of the task ends it: Dask starts a task again if its first worker is lost.
        """
        if self._begin not in ("", event["begin"]):
            self.end(Outcome(failure="The Dask worker that ran it was lost.", lost=True))
        self._begin = event["begin"]
        self._started, self._spent = time.monotonic() - event["age"], event["spent"]
        self._steps.extend(Step(*step) for step in event["steps"])

    def await_anew(self) -> None:
        """Forget the run of the task, so that the run after the loss of a scheduler counts as the first."""
        self._begin, self._started = "", None

    def contents(self) -> Mapping[str, bytes]:
        """Return the contents of the stored results that the task reads."""
        return {key: file.read_bytes() for key, file in self.order.stored.items()}

    def take(self, done: Done) -> None:
        """Take the products of a worker; its files go where a child of this machine leaves them."""
        products = []
        for number, (product, content) in enumerate(zip(done.outcome.products, done.contents, strict=True)):
            file = self.order.workspace / f"{number}_{product.file.name}"
            file.write_bytes(content)
            products.append(replace(product, file=file))
        self._log.write_bytes(done.log)
        self.usage, self.compliance_reads = done.usage, done.compliance_reads
        self.warnings = list(done.warnings)
        self.end(replace(done.outcome, products=tuple(products)))

    def end(self, outcome: Outcome) -> None:
        """Take the outcome of the task; later reports are ignored."""
        self._outcome = self._outcome or outcome

    @property
    def ended(self) -> bool:
        """Whether the outcome of the task is known."""
        return self._outcome is not None

    def listen(self) -> tuple[list[Step], bool]:
        """Return the progress since the last call, and whether it has ended."""
        ended = self.ended
        return [self._steps.popleft() for _ in range(len(self._steps))], ended

    def finish(self) -> Outcome:
        """Return the outcome of the task, which Dask keeps until the task is killed."""
        assert self._outcome is not None
        return self._outcome

    def kill(self, _patience_s: float | None = None) -> None:
        """Cancel the task, or drop its result; its worker kills the child process within half a second."""
        self._drop(self.name)

    end_group = kill


class Cluster:
    """The tasks of a server on a shared Dask scheduler; a `deployment` distinguishes the servers.

    `maximum` jobs run at the same time: one for each thread of its workers; 0 while they are away.
    """

    keeps = True
    """Whether jobs go on while the server is stopped."""

    def __init__(self, address: str, deployment: str) -> None:
        self._address, self._name = address, f"loa-{deployment[:12]}"
        self.maximum = 0
        self._tasks: dict[str, Task] = {}
        self._known: set[str] = set()  # addresses of workers whose versions were checked
        self._away = ""  # the fault that was logged last; empty: none
        self._lock, self._stopping = threading.Lock(), False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None

    def check(self) -> None:
        """Raise `BadInput` if the scheduler is silent, has no workers, or has workers of other programs."""
        with ThreadPoolExecutor(1) as thread:  # the caller's may have an event loop of its own
            bound, tip = thread.submit(lambda: asyncio.run(self._fault_at_start())).result()
        if bound:
            raise BadInput.of("scheduler", self._address, bound, tip)

    async def _fault_at_start(self) -> tuple[str, str]:
        """Return the fault of a first connection and its remedy, as `_fault`."""
        try:
            async with dask_cluster.connection(self._address, asynchronous=True) as client:
                with suppress(TimeoutError):
                    await client.wait_for_workers(1, timeout=dask_cluster.CONNECT_S)
                return await self._fault(client)
        except (OSError, TimeoutError) as error:
            port = self._address.rpartition(":")[2]
            return (
                f"that of a Dask scheduler that answers ({error})",
                f"Start one: dask scheduler --port {port}",
            )

    async def _fault(self, client: Client) -> tuple[str, str]:
        """Return the fault that keeps work from the workers and its remedy, and set `maximum`.

        The fault is worded as the bound of a `BadInput`: "that of a scheduler with workers". It is empty if
        there is none; the remedy is then without meaning.
        """
        threads = await client.nthreads()
        self._known &= threads.keys()
        start = f"dask worker {self._address} --nthreads 1 --nworkers 4"
        fault = "" if threads else "that of a scheduler with workers"
        fresh = sorted(threads.keys() - self._known)
        answers = await client.run(program, workers=fresh, on_error="return") if fresh else {}
        for worker, versions in answers.items():
            if versions == program():
                self._known.add(worker)
            else:
                fault = f"of workers with {program()}: {worker} has {versions}"
        self.maximum = 0 if fault else sum(threads.values())
        return fault, f"Start them: {start}, from an installation of this version with its extras."

    def start(self, notify: Callable[[], None]) -> None:
        """Connect, and stay connected; `notify` is called when a task ends, or when workers come."""
        self._notify, self._stopping = notify, False
        self._thread = threading.Thread(target=lambda: asyncio.run(self._main()), name="dask", daemon=True)
        self._thread.start()

    def hurry(self) -> None:
        """Do nothing: unlike processes of this machine, tasks have no starts in progress to finish."""

    def close(self) -> None:
        """Disconnect; the tasks stay with Dask."""
        self._stopping = True
        self._wake()
        if self._thread is not None:
            self._thread.join(_STOPPING_S)
            self._thread = None
        self._tasks.clear()

    def begin(self, order: WorkOrder, name: str, log: Path) -> Task:
        """Hand a job to Dask, or find the task of this name that it has."""
        task = Task(f"{self._name}-{order.key}-{name}", order, log, self._drop)
        with self._lock:
            self._tasks[task.name] = task
        self._wake()
        return task

    def _drop(self, name: str) -> None:
        with self._lock:
            self._tasks.pop(name, None)
        self._wake()

    def _wake(self) -> None:
        with suppress(RuntimeError):  # the loop has ended
            if self._loop is not None:
                self._loop.call_soon_threadsafe(self._changed.set)

    async def _main(self) -> None:
        """Connect and serve until stopped; connect again after each lost connection."""
        self._loop, self._changed = asyncio.get_running_loop(), asyncio.Event()
        while not self._stopping:
            try:
                async with dask_cluster.connection(self._address, asynchronous=True) as client:
                    client.subscribe_topic(self._name, self._hear)
                    await self._serve(client)
            except Exception as error:  # noqa: BLE001 (the next connection may do)
                self._say(f"the scheduler {self._address} is lost: {error or type(error).__name__}")
                await asyncio.sleep(_LOOK_S)
            self.maximum = 0

    async def _serve(self, client: Client) -> None:
        """Submit wanted tasks and cancel others, until the connection is lost or `close` is called."""
        following: dict[Task, asyncio.Task[None]] = {}
        names = map(str, await client.list_datasets())
        stored = {name for name in names if name.startswith(self._name)}  # by an earlier run of the server
        checked = 0.0  # monotonic time of the last check of the workers, s
        try:
            while not self._stopping:
                self._changed.clear()
                if str(client.status) != "running":
                    raise OSError("the connection broke")
                if time.monotonic() - checked > _LOOK_S:
                    fault, tip = await self._fault(client)
                    self._say(f"scheduler {self._address}: not {fault}. {tip}" if fault else "")
                    checked = time.monotonic()
                with self._lock:
                    wanted = dict(self._tasks)
                dropped = following.keys() - wanted.values()
                for task in dropped:
                    following.pop(task).cancel()
                for name in {task.name for task in dropped} | stored - wanted.keys():
                    await self._forget(client, name)
                stored = set()
                for task in wanted.values():
                    if not task.ended and (task not in following or following[task].done()):
                        following[task] = asyncio.create_task(self._follow(client, task))
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._changed.wait(), _LOOK_S)
        finally:
            for follower in following.values():
                follower.cancel()

    async def _forget(self, client: Client, name: str) -> None:
        """Cancel a task that nobody wants, or whose result is stored."""
        from distributed import Future  # noqa: PLC0415 (an extra)

        await client.cancel([Future(name, client)], force=True)
        await client.unpublish_dataset(name)

    async def _follow(self, client: Client, task: Task) -> None:
        """Submit a task, wait for its end, and take its products."""
        task.await_anew()
        try:
            done = await self._done(client, task, await asyncio.to_thread(task.contents))
            if isinstance(done, Done):
                await asyncio.to_thread(task.take, done)
            elif done is not None:
                task.end(done)
        except OSError as error:
            logger.exception("files of a task", task=task.name)
            task.end(Outcome(failure=no_space(error) or "unexpected", unexpected=not no_space(error)))
        self._notify()

    async def _done(self, client: Client, task: Task, files: Mapping[str, bytes]) -> Done | Outcome | None:
        """Submit a task, or find the one of its name, and wait for it.

        Returns its products, or the outcome of a failure; None: the connection failed, submit it again.
        """
        from distributed import KilledWorker  # noqa: PLC0415 (an extra)

        arguments = (task.order.line(), files, self._name, program())
        future = client.submit(do_job, *arguments, key=task.name, pure=False)
        try:
            await client.publish_dataset(future, name=task.name, override=True)
            done: Done | None = await future
            if done is None:  # cancelled for an earlier submission of this name
                await self._forget(client, task.name)
            return done
        except CancelledError:
            return None
        except KilledWorker:
            text = "Every Dask worker that tried it ended; they may have run out of memory."
            return Outcome(failure=text, lost=True)
        except Exception as error:
            if isinstance(error, OSError) and future.status != "error":
                return None  # a transfer between server and scheduler failed, not the task
            logger.exception("task failed", task=task.name)
            full = isinstance(error, OSError) and no_space(error, "the folder of the Dask worker")
            text = full or "The Dask worker could not do it; the log of the service has the reason."
            return Outcome(failure=text, died=True)

    def _hear(self, event: tuple[float, Mapping[str, Any]]) -> None:
        report = event[1]
        with self._lock:
            task = self._tasks.get(report["task"])
        if task is not None:
            task.hear(report)

    def _say(self, fault: str) -> None:
        """Log a fault that keeps jobs waiting, or its end (empty text); each is logged once."""
        if fault != self._away:
            (logger.warning if fault else logger.info)(
                "cluster away" if fault else "cluster back", reason=fault
            )
            self._away = fault
            self._notify()
