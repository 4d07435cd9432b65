"""The scheduler: one thread that claims computations, minds their workers and stores what they make."""

from __future__ import annotations

import contextlib
import os
import selectors
import shutil
import threading
import uuid
from dataclasses import dataclass
from pathlib import Path

import structlog

from service.jobs.claims import Claim, Claims
from service.jobs.memory import machine_memory_mb
from service.jobs.order import Outcome, WorkOrder
from service.jobs.process import Registry
from service.jobs.worker import Worker
from service.settings import LEAST_MEMORY_MB, Settings
from service.store import ResultStore

_HEARTBEAT_S = 0.5
logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class _Running:
    """A claim and the process that works on it."""

    claim: Claim
    worker: Worker
    log: Path


class Scheduler:
    """Runs what waits, at most `settings.workers` at a time."""

    def __init__(self, settings: Settings, registry: Registry, claims: Claims, store: ResultStore) -> None:
        self._settings, self._registry, self._claims, self._store = settings, registry, claims, store
        self._running: dict[int, _Running] = {}
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self._wake_in: int | None = None

    def start(self) -> None:
        """Take up what a dead service left behind, then begin; may be started again after a stop."""
        for name in ("work", "log"):
            (self._settings.data_directory / name).mkdir(parents=True, exist_ok=True)
        for claim in self._claims.running():
            self._again_or_fail(claim, "The service ended while it ran.")
        self._clear(self._claims.waiting())
        self._selector = selectors.DefaultSelector()
        self._wake_out, self._wake_in = os.pipe()
        for end in (self._wake_out, self._wake_in):
            os.set_blocking(end, False)
        self._selector.register(self._wake_out, selectors.EVENT_READ)
        self._stopping.clear()
        self._thread = threading.Thread(target=self._loop, name="scheduler", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Kill the workers, let their computations wait for the next start, and end the thread."""
        if self._thread is None or self._wake_in is None:
            return
        self._stopping.set()
        self.wake()
        self._thread.join()
        wake_in, self._wake_in, self._thread = self._wake_in, None, None
        self._selector.close()
        os.close(self._wake_out)
        os.close(wake_in)

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread is not None and self._thread.is_alive()

    def wake(self) -> None:
        """Look at the table now: something was submitted or dismissed."""
        if self._wake_in is not None:
            with contextlib.suppress(BlockingIOError):  # the pipe is full of wake-ups already
                os.write(self._wake_in, b".")

    def _loop(self) -> None:
        """Until stopped: claim, listen, enforce. A turn that fails is logged and the next one tries again."""
        while not self._stopping.is_set():
            try:
                self._turn()
            except Exception:
                logger.exception("scheduler turn failed")
                self._stopping.wait(_HEARTBEAT_S)
        for running in list(self._running.values()):
            self._forget(running).kill()
            self._claims.put_back(running.claim.id, "Waits: the service was stopped.", counted=False)

    def _turn(self) -> None:
        """Do one round."""
        while len(self._running) < self._settings.workers and (claim := self._claims.claim()) is not None:
            self._begin(claim)
        for key, _ in self._selector.select(_HEARTBEAT_S):
            if key.fd == self._wake_out:
                os.read(self._wake_out, 65536)
            elif key.fd in self._running:
                self._listen(self._running[key.fd])
        self._enforce()

    def _begin(self, claim: Claim) -> None:
        """Start a worker for a claim."""
        workspace = self._settings.data_directory / "work" / claim.id
        log = self._settings.data_directory / "log" / f"{claim.id}.log"
        try:
            entry = self._registry[claim.process].entry
            workspace.mkdir(parents=True, exist_ok=True)
            data, memory_mb = self._settings.data_directory, _memory_mb(self._settings)
            order = WorkOrder(entry, claim.inputs, claim.key, workspace, data, memory_mb)
            worker = Worker(order, log)
        except Exception:
            reference = uuid.uuid4().hex[:12]
            logger.exception("no worker could be started", computation=claim.id, reference=reference)
            text = f"No worker could be started. The log has the details under {reference}."
            self._claims.fail(claim.id, text, reference=reference)
            return
        self._running[worker.channel] = _Running(claim, worker, log)
        self._selector.register(worker.channel, selectors.EVENT_READ)
        logger.info("worker started", computation=claim.id, process=claim.process, pid=worker.pid)

    def _listen(self, running: _Running) -> None:
        """Note progress; take the outcome when the channel ends."""
        steps, ended = running.worker.listen()
        process = self._registry[running.claim.process]
        if steps and not ended:
            stage, fraction = steps[-1]
            self._claims.progress(running.claim.id, stage, fraction, process.overall(stage, fraction))
        if ended:
            self._settle(running.claim, self._forget(running).finish(), running.log)

    def _forget(self, running: _Running) -> Worker:
        """Stop listening to a worker."""
        self._selector.unregister(running.worker.channel)
        del self._running[running.worker.channel]
        return running.worker

    def _settle(self, claim: Claim, outcome: Outcome, log: Path) -> None:
        """Store what was made, or note why there is nothing."""
        try:
            if outcome.died:
                self._again_or_fail(claim, outcome.failure)
            elif outcome.unexpected:
                reference = uuid.uuid4().hex[:12]
                logger.error("worker failed", computation=claim.id, reference=reference, log=str(log))
                text = f"Something failed that should not. The log has the details under {reference}."
                self._claims.fail(claim.id, text, reference=reference)
            elif outcome.failure:
                self._claims.fail(claim.id, outcome.failure, outcome.faults)
            else:
                for product in outcome.products:
                    self._store.put(product.key, product.kind, product.file)
                self._claims.succeed(claim.id)
        finally:
            if not outcome.died or claim.attempts >= self._settings.attempts:
                shutil.rmtree(self._settings.data_directory / "work" / claim.id, ignore_errors=True)

    def _clear(self, waiting: set[str]) -> None:
        """Remove the workspaces of all but those that wait: they may go on from what is there."""
        for workspace in (self._settings.data_directory / "work").iterdir():
            if workspace.name not in waiting:
                shutil.rmtree(workspace, ignore_errors=True)

    def _again_or_fail(self, claim: Claim, reason: str) -> None:
        """Give work that died another attempt, as long as there are any."""
        most = self._settings.attempts
        if claim.attempts < most:
            self._claims.put_back(
                claim.id, f"{reason} Waits for attempt {claim.attempts + 1} of {most}.", counted=True
            )
        else:
            self._claims.fail(claim.id, f"{reason} That was attempt {claim.attempts} of {most}.")

    def _enforce(self) -> None:
        """End workers that are past the deadline or that nobody wants."""
        unwanted = self._claims.dismissed({running.claim.id for running in self._running.values()})
        for running in list(self._running.values()):
            late = running.worker.age > self._settings.deadline_s
            if late or running.claim.id in unwanted:
                self._forget(running).kill()
                shutil.rmtree(self._settings.data_directory / "work" / running.claim.id, ignore_errors=True)
            if late:
                self._claims.fail(running.claim.id, _too_late(self._settings.deadline_s))


def _memory_mb(settings: Settings) -> int:
    """Return what one worker may have, MB: what is set, or its share of the machine's memory."""
    if settings.memory_limit_mb is not None:
        return settings.memory_limit_mb
    return max(LEAST_MEMORY_MB, machine_memory_mb() // settings.workers)


def _too_late(deadline_s: float) -> str:
    """Return what a job is told that took too long."""
    return (
        f"The deadline of {deadline_s:g} s (LOA_DEADLINE_S) passed. Ask for a coarser level or fewer "
        "positions, of a run for a shorter one, or start the service with a later deadline."
    )
