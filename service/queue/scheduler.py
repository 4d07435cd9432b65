"""The scheduler: a thread that claims computations, minds workers, settles ends.

A computation waits in the job table. The scheduler claims it; an attempt is a claim and the worker that a
crew has started for it. Children of this process are one crew; they end with the server. A Dask cluster is
the other crew: it `keeps` its workers beyond the end of the server, and the next server finds them by name.
The end of an attempt is settled: its products are stored, or its computation fails or waits again.

One server owns the job table by a lock (`service.store.ownership.Ownership`). A server that loses the lock
starts and notes nothing until it has the lock again, while its workers go on. If another server has the lock
by then, the workers are killed.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import shutil
import threading
import time

import structlog

from host import never_wait_at
from lineofaction.gearbox.problems import BadInput, DatabaseUnavailable, ServiceError, StoreUnavailable
from service.queue.attempt import Attempt, begun
from service.queue.claims import Claim, Claims, Reached
from service.queue.crew import Children, Crew, Run
from service.queue.renewal import Renewal
from service.queue.retention import Housekeeper
from service.queue.settlement import Ended, Settlement
from service.queue.worker_figures import WorkerFigures
from service.settings import Settings
from service.store.ownership import Ownership
from service.store.results import ResultStore
from service.worker.order import Outcome
from service.worker.process import Registry

_TURN_S = 0.5
"""Longest wait in s of a turn for news of workers."""
_NOTED_EVERY_S = 0.25
"""Least time in s between two records of the progress of a job."""
_STOPPING_S = 1.0
"""Seconds for which a stop waits until killed workers are dead."""
_OUTAGES = (DatabaseUnavailable, StoreUnavailable)
"""Errors after which an end or progress is recorded later."""
logger = structlog.get_logger(__name__)


class Scheduler:
    """A thread that lets a crew execute waiting computations: children of this machine, or a Dask cluster."""

    def __init__(
        self,
        settings: Settings,
        registry: Registry,
        claims: Claims,
        store: ResultStore,
        owner: Ownership,
        housekeeper: Housekeeper | None = None,
        crew: Crew | None = None,
    ) -> None:
        self._settings, self._registry, self._claims = settings, registry, claims
        self._owner, self._housekeeper = owner, housekeeper
        self._crew: Crew = crew or Children(settings, registry.modules)
        self._store = store
        self._settlement = Settlement(claims, store, settings.attempts, alone=not self._crew.keeps)
        # the next three by the ids of computations
        self._running: dict[str, Attempt] = {}
        self._progress: dict[str, tuple[Claim, Reached]] = {}  # not yet in the table
        self._noted_as_begun: set[str] = set()  # whose children have begun, as the table has it
        self._renewal = Renewal(claims, registry, store, settings.data_directory / "work")
        self._unsettled: list[Ended] = []
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self._wake_in: int | None = None
        self._doubtful = False  # whether the table may say of work that it runs, and it does not
        self._noted_at = 0.0
        self._turned_at = 0.0
        self.figures = WorkerFigures()

    def start(self) -> None:
        """Take up the work of a dead service, then begin, also after a stop.

        Raises `BadInput`: another server owns the table.
        """
        self._owner.acquire()
        for name in ("work", "log"):
            (self._settings.data_directory / name).mkdir(parents=True, exist_ok=True)
        self._selector = selectors.DefaultSelector()
        self._wake_out, self._wake_in = os.pipe()
        for end in (self._wake_out, self._wake_in):
            never_wait_at(end)
        self._selector.register(self._wake_out, selectors.EVENT_READ)
        self._stopping.clear()
        self._turned_at = time.monotonic()
        self._take_up()
        self._crew.start(self.wake)  # after it knows which tasks of a former server are wanted
        self._clear()
        if self._housekeeper is not None:
            self._housekeeper.start()
        self._thread = threading.Thread(target=self._loop, name="scheduler", daemon=True)
        self._thread.start()
        self.wake()

    def stop(self) -> None:
        """Kill the workers, let their computations wait for the next start, and end the thread."""
        if self._thread is None or self._wake_in is None:
            return
        self._stopping.set()
        self._crew.hurry()
        self.wake()
        self._thread.join()
        if self._housekeeper is not None:
            self._housekeeper.stop()
        wake_in, self._wake_in, self._thread = self._wake_in, None, None
        self._selector.close()
        os.close(self._wake_out)
        os.close(wake_in)
        self._owner.release()

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread is not None and self._thread.is_alive()

    @property
    def turn_age_s(self) -> float:
        """Seconds since its last turn ended, well or not; turns follow each other within `_TURN_S`."""
        return time.monotonic() - self._turned_at

    @property
    def busy(self) -> int:
        """Workers that run."""
        return len(self._running)

    @property
    def maximum(self) -> int:
        """Workers that may run at the same time."""
        return self._crew.maximum

    def wake(self) -> None:
        """Look at the table now: something was submitted or dismissed."""
        if self._wake_in is not None:
            with contextlib.suppress(BlockingIOError):  # the pipe is full of wake-ups already
                os.write(self._wake_in, b".")

    def give_up(self) -> None:
        """Let another server have the job table, as this one will not start, or has stopped."""
        if not self.alive:
            self._owner.release()

    def _loop(self) -> None:
        """Until stopped: claim, listen, enforce. A turn that fails is logged and the next one tries again."""
        while not self._stopping.is_set():
            try:
                self._turn()
            except Exception as error:
                if isinstance(error, _OUTAGES):
                    logger.warning("scheduler turn failed", error=str(error))
                else:
                    logger.exception("scheduler turn failed")
                self._doubtful = True
                self._stopping.wait(_TURN_S)
            self._turned_at = time.monotonic()
        self._put_all_back()
        self._crew.close()

    def _put_all_back(self) -> None:
        """End all workers that cannot outlive the server; unsaved ends wait for the next start."""
        running = [] if self._crew.keeps else list(self._running.values())
        for run in running:
            run.worker.end_group()
        deadline = time.monotonic() + _STOPPING_S
        for run in running:
            self._kill(run, "stopped", patience_s=max(deadline - time.monotonic(), 0.0))
        with contextlib.suppress(ServiceError):
            self._confirm_ownership()
            self._settle_all()
            for run in running:
                self._claims.put_back(run.claim, "Waits: the service was stopped.", counted=False)

    def _turn(self) -> None:
        """Do one round; steps without the database come first."""
        self._listen_to_all()
        self._enforce_deadline()
        self._confirm_ownership()
        self._put_back_strays()
        self._settle_all()
        self._note_runs()
        self._enforce_dismissals()
        self._enforce_costs()
        self._note_progress()
        self._clear()
        self._claims.advance_batches()
        while len(self._running) < self._crew.maximum and (claim := self._next()) is not None:
            self._begin(claim)

    def _next(self) -> Claim | None:
        """Claim the next computation; one of another version is renewed before, or ends."""
        # Only children share a machine: a suspect, which has lost several runs, must have it to itself.
        alongside = bool(self._running) and not self._crew.keeps
        if alongside and any(running.claim.suspect for running in self._running.values()):
            return None
        while (claim := self._claims.claim(alongside=alongside)) is not None:
            if claim.program == self._claims.program:
                return claim
            self._renewal.renew(claim)
        return None

    def _note_runs(self) -> None:
        """Note in the table which children have begun: if this server dies, their runs count as lost."""
        if self._crew.keeps:
            return
        claims = [attempt.claim for attempt in self._running.values() if attempt.worker.begun]
        claims = [claim for claim in claims if claim.id not in self._noted_as_begun]
        if claims:
            self._claims.note_runs(claims)
            self._noted_as_begun.update(claim.id for claim in claims)

    def _listen_to_all(self) -> None:
        """Hear workers and wake-ups; wait for one if there is none."""
        for key, _ in self._selector.select(_TURN_S):
            if key.fd == self._wake_out:
                os.read(self._wake_out, 65536)
        for running in list(self._running.values()):
            self._listen(running)

    def _begin(self, claim: Claim) -> None:
        try:
            process = self._registry[claim.process]
            attempt = begun(self._settings, process, claim, self._crew, self._store, self.figures)
        except _OUTAGES:
            raise  # the table says that it runs: `_put_back_strays` lets it wait again
        except ServiceError as error:
            self._claims.fail(claim, str(error))
            return
        except Exception:  # noqa: BLE001 (the log has it)
            self._settlement.fail_by_log(claim, "No worker could be started.", exc_info=True)
            return
        self._running[claim.id] = attempt
        if attempt.worker.channel is not None:
            self._selector.register(attempt.worker.channel, selectors.EVENT_READ)

    def _listen(self, running: Attempt) -> None:
        """Note progress; take the outcome when the channel ends."""
        steps, ended = running.worker.listen()
        running.trace.see(steps)
        if ended:
            outcome = self._forget(running).finish()
            self._unsettled.append(Ended(running, outcome))
            running.note_end(outcome.name)
        elif steps:
            last = steps[-1]
            # fraction of the whole work: as the worker says, else from the usual shares of the stages
            whole = last.whole
            if whole is None:
                whole = running.fraction.at(last.stage, last.fraction, running.worker.age)
            self._progress[running.claim.id] = running.claim, Reached(last.stage, last.fraction, whole)

    def _forget(self, running: Attempt) -> Run:
        """Take an attempt from those that run; return its worker, which may not have ended."""
        if running.worker.channel is not None:
            self._selector.unregister(running.worker.channel)
        del self._running[running.claim.id]
        self._progress.pop(running.claim.id, None)
        self._noted_as_begun.discard(running.claim.id)
        return running.worker

    def _kill(self, running: Attempt, why: str, failure: str = "", patience_s: float | None = None) -> None:
        """Kill a worker; a failure in words for the user ends its computation."""
        self._forget(running).kill(patience_s)
        running.note_end(why)
        if failure:
            self._unsettled.append(Ended(running, Outcome(failure=failure)))

    def _settle_all(self) -> None:
        """Settle ended computations in turn; an end waits while database or store do not take it."""
        while self._unsettled:
            ended = self._unsettled[0]
            try:
                self._settlement.settle(ended)
            except _OUTAGES:
                raise
            except ServiceError:
                logger.exception("outcome could not be settled", computation=ended.attempt.claim.id)
            ended.attempt.worker.kill()  # a cluster keeps outcomes until then
            self._unsettled.pop(0)

    def _known(self) -> list[Attempt]:
        """Return the attempts that run or have to be settled."""
        return [*self._running.values(), *(ended.attempt for ended in self._unsettled)]

    def _clear(self) -> None:
        """Remove the workspaces of computations that neither run nor wait for their next attempt."""
        used = {run.workspace for run in self._known()}
        left = set((self._settings.data_directory / "work").iterdir()) - used
        waiting = self._claims.waiting() if left else ()
        for workspace in left:
            if workspace.name not in waiting:
                shutil.rmtree(workspace, ignore_errors=True)

    def _confirm_ownership(self) -> None:
        """Confirm the ownership of the table, or acquire it again if its connection was lost."""
        if not self._owner.lost():
            return
        logger.warning("job table lost")
        try:
            self._owner.acquire()
        except BadInput:
            for running in list(self._running.values()):
                self._kill(running, "table lost")
            self._unsettled.clear()
            raise DatabaseUnavailable("Another server owns the job table.") from None
        logger.warning("job table owned again")
        self._doubtful = True

    def _put_back_strays(self) -> None:
        """Put back computations that run according to the table, but have no worker of this server.

        A step of the scheduler that failed half-way leaves them, or another server that died.
        """
        if not self._doubtful:
            return
        known = {run.claim.id for run in self._known()}
        for claim in self._claims.running():
            if claim.id not in known:
                self._claims.put_back(claim, "Waits: the database was lost.", counted=False)
        self._doubtful = False

    def _take_up(self) -> None:
        """Find the work of a dead service again, if the crew kept it; else let it wait, or fail.

        A child that had begun has lost a run. Computations that lose several runs fail in the end.
        """
        for claim in self._claims.running():
            if claim.program != self._claims.program:
                self._claims.put_back(claim, "Waits: the service was upgraded.", counted=False)
            elif self._crew.keeps:
                self._begin(claim)
            else:
                when = "while it ran" if claim.lost_runs else "before it had begun"
                self._settlement.free_or_fail(claim, f"The service ended {when}.", claim.lost_runs)

    def _note_progress(self) -> None:
        """Write down how far works are, at most every `_NOTED_EVERY_S`."""
        if self._progress and time.monotonic() - self._noted_at > _NOTED_EVERY_S:
            self._claims.progress(list(self._progress.values()))
            self._progress.clear()
            self._noted_at = time.monotonic()

    def _enforce_deadline(self) -> None:
        deadline_s = self._settings.deadline_s
        text = (
            f"The deadline of {deadline_s:g} s (LOA_DEADLINE_S) passed. Select a coarser level or fewer "
            "positions, of a run for a shorter one, or start the service with a later deadline."
        )
        for running in list(self._running.values()):
            if running.worker.age > deadline_s:
                self._kill(running, "too late", text)

    def _enforce_costs(self) -> None:
        """End workers that have used the CPU time that their computation may take."""
        for running in list(self._running.values()):
            if (why := running.too_costly(self._claims)) is not None:
                self._kill(running, "too costly", why)

    def _enforce_dismissals(self) -> None:
        """End workers of computations that nobody wants."""
        live = self._claims.still_running([running.claim for running in self._running.values()])
        for running in list(self._running.values()):
            if running.claim.id not in live:
                self._kill(running, "not wanted")
                shutil.rmtree(running.workspace, ignore_errors=True)
