"""Jobs as tasks of a Dask scheduler, one each: found again by their names, cancelled, counted, brought home.

A thread with an event loop of its own speaks with Dask. What it is to do follows from the tasks that are
wanted: those that a fresh connection does not know are submitted, under names by which Dask finds the ones it
has. So a scheduler that was lost, and a server that was started again, are the same case. Each task is
published: it stays when the server is gone.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError
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
"""Seconds between two looks at the connection and at the workers."""
_STOPPING_S = 2.0
"""Seconds for which a stop waits for a connection that is being made."""
logger = structlog.get_logger(__name__)


class Task:
    """A job that was handed to Dask; it offers the same as `service.worker.worker.Worker` of this machine."""

    channel: int | None = None
    """Descriptor that wakes the scheduler; None: a task of Dask wakes the scheduler by itself."""

    def __init__(self, name: str, order: WorkOrder, log: Path, drop: Callable[[str], None]) -> None:
        self.name, self.order, self._log, self._drop = name, order, log, drop
        self.usage: Usage | None = None
        self.compliance_reads, self.warnings = CacheReads(), list[str]()
        self._begin = ""
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
        """Take the report of a worker; a second beginning ends this run: who began it first was lost."""
        if self._begin not in ("", event["begin"]):
            self.end(Outcome(failure="The Dask worker that ran it was lost.", lost=True))
        self._begin = event["begin"]
        self._started, self._spent = time.monotonic() - event["age"], event["spent"]
        self._steps.extend(Step(*step) for step in event["steps"])

    def await_anew(self) -> None:
        """Take the next beginning for the first: a scheduler was lost, which is not its fault."""
        self._begin, self._started = "", None

    def contents(self) -> Mapping[str, bytes]:
        """Return the contents of the stored results that it reads."""
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
        """Whether it is known how."""
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
        """Cancel it, or drop its result; its worker kills the child within half a second."""
        self._drop(self.name)

    end_group = kill


class Cluster:
    """The tasks of a server on a shared Dask scheduler; a `deployment` distinguishes the servers.

    `maximum` jobs run at the same time: one for each thread of its workers; 0 while they are away.
    """

    keeps = True

    def __init__(self, address: str, deployment: str) -> None:
        self._address, self._name = address, f"loa-{deployment[:12]}"
        self.maximum = 0
        self._tasks: dict[str, Task] = {}
        self._known: set[str] = set()
        self._away = ""
        self._lock, self._stopping = threading.Lock(), False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None

    def check(self) -> None:
        """Raise `BadInput` of a scheduler that does not answer or lacks workers, or of other programs."""
        bound, tip = asyncio.run(self._fault_at_start())
        if bound:
            raise BadInput.of("scheduler", self._address, bound, tip)

    async def _fault_at_start(self) -> tuple[str, str]:
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
        """Return why no work is sent, with a remedy; empty: it is sent. Counts the working threads."""
        threads = await client.nthreads()  # type: ignore[no-untyped-call]
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
        """Do nothing: to begin takes no time."""

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
        """Until stopped: connect, serve; a connection that is lost is made again."""
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
        """Submit wanted tasks, cancel others; end when the connection is lost."""
        following: dict[Task, asyncio.Task[None]] = {}
        names = map(str, await client.list_datasets())  # type: ignore[no-untyped-call]
        left = {name for name in names if name.startswith(self._name)}
        looked = 0.0
        try:
            while not self._stopping:
                self._changed.clear()
                if str(client.status) != "running":
                    raise OSError("the connection broke")
                if time.monotonic() - looked > _LOOK_S:
                    fault, tip = await self._fault(client)
                    self._say(f"scheduler {self._address}: not {fault}. {tip}" if fault else "")
                    looked = time.monotonic()
                with self._lock:
                    current = dict(self._tasks)
                dropped = following.keys() - current.values()
                for task in dropped:
                    following.pop(task).cancel()
                for name in {task.name for task in dropped} | left - current.keys():
                    await self._forget(client, name)
                left = set()
                for task in current.values():
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

        await client.cancel([Future(name, client)], force=True)  # type: ignore[no-untyped-call]
        await client.unpublish_dataset(name)

    async def _follow(self, client: Client, task: Task) -> None:
        """Let a task be done, and take its products."""
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
        """Submit a task, or join the present one; return its products, or the reason; None: try anew."""
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
                return None  # in a transfer
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
        """Log once the fault that keeps jobs waiting, and its end."""
        if fault != self._away:
            (logger.warning if fault else logger.info)(
                "cluster away" if fault else "cluster back", reason=fault
            )
            self._away = fault
            self._notify()
