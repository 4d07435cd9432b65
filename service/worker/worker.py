"""A worker process seen from the service: start, listen, end."""

from __future__ import annotations

import contextlib
import json
import os
import time
from pathlib import Path
from typing import Any, NamedTuple

from fe_contact.cache_reads import CacheReads
from host import Ended, ending_signal, family_cpu_seconds, kill_group, never_wait_at
from service.worker.forks import Ends, Launch, start_child
from service.worker.order import Outcome, Product, WorkOrder
from service.worker.usage import BYTES_PER_MB, Usage

_LEAVING_S = 2.0
_OF_LITTLE_MEMORY = ("SIGKILL", "SIGABRT")  # by the system, and by libraries that cannot go on


class Step(NamedTuple):
    """Progress of a worker: a stage, the fraction of it that is done, and that of the whole if it is known.

    It was reported `at` s since 1970, after so much CPU time with what it has waited for.
    """

    stage: str
    fraction: float
    whole: float | None
    at: float
    cpu_s: float


class Worker:
    """One child process for one order, leader of a session of its own; it has `begun` once it says so."""

    def __init__(self, order: WorkOrder, log: Path, launch: Launch = start_child) -> None:
        self.started = time.monotonic()
        self.usage: Usage | None = None
        self.compliance_reads = CacheReads()
        self.warnings: list[str] = []
        self.begun = False
        self._outcome: Outcome | None = None
        self._ended: Ended | None = None
        self._peak_mb: float | None = None
        self._rest = b""
        theirs, self._orders = os.pipe()
        self.channel, answers = os.pipe()
        never_wait_at(self.channel)
        try:
            with log.open("wb") as stream:
                self._process = launch(Ends(theirs, answers, stream.fileno(), order.workspace))
        except OSError:
            os.close(self.channel)
            os.close(self._orders)
            raise
        finally:
            os.close(theirs)
            os.close(answers)
        # a child that died before reading the order shows when its channel ends
        with contextlib.suppress(BrokenPipeError), os.fdopen(self._orders, "wb", closefd=False) as stream:
            stream.write(order.line())

    @property
    def pid(self) -> int:
        """Process id, also of its group and session."""
        return self._process.pid

    @property
    def age(self) -> float:
        """Seconds since the start."""
        return time.monotonic() - self.started

    @property
    def facts(self) -> dict[str, Any]:
        """What names it in the log."""
        return {"pid": self.pid}

    def spent(self) -> float | None:
        """Return the CPU seconds of the child and its children so far; None: it has ended."""
        return family_cpu_seconds(self.pid)

    def listen(self) -> tuple[list[Step], bool]:
        """Return the progress since the last call, and whether the child closed its channel."""
        piece = b""
        ended = False
        with contextlib.suppress(BlockingIOError):
            while True:
                part = os.read(self.channel, 65536)
                if not part:
                    ended = True
                    break
                piece += part
        *lines, self._rest = (self._rest + piece).split(b"\n")
        messages = [json.loads(line) for line in lines]
        return [step for message in messages if (step := self._taken(message)) is not None], ended

    def _taken(self, message: dict[str, Any]) -> Step | None:
        """Return a message as progress, or keep it as the outcome."""
        if "stage" in message:
            return Step(**message)
        if "begun" in message:
            self.begun = True
            return None
        if "warning" in message:
            self.warnings.append(message["warning"])
            return None
        self._peak_mb = message.get("peak_mb")
        self.compliance_reads = CacheReads(**message.get("compliance_reads", {}))
        products = tuple(Product(**p | {"file": Path(p["file"])}) for p in message.get("products", ()))
        facts = {name: message[name] for name in ("failure", "unexpected") if name in message}
        self._outcome = Outcome(products=products, faults=tuple(message.get("faults", ())), **facts)
        return None

    def finish(self) -> Outcome:
        """End the process group, reap the child and return how it ended."""
        self._has_exited(_LEAVING_S)
        self.kill()
        if self._outcome is not None:
            return self._outcome
        assert self._ended is not None
        text = f"The worker ended early with exit code {self._ended.code}."
        if name := ending_signal(self._ended.code):
            hint = " (it may have run out of memory)" if name in _OF_LITTLE_MEMORY else ""
            text = f"The worker was ended by {name}{hint}."
        return Outcome(failure=text, died=self.begun, lost=not self.begun)

    def _has_exited(self, patience_s: float) -> bool:
        """Whether the child leaves within a moment; unreaped, its id is given to no other group."""
        deadline = time.monotonic() + patience_s
        while not self._process.has_exited():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.005)
        return True

    def end_group(self) -> None:
        """Send the group (gmsh's process included) SIGKILL."""
        if self._ended is None:
            with contextlib.suppress(ProcessLookupError):
                kill_group(self.pid)

    def kill(self, patience_s: float | None = None) -> None:
        """Kill the group, reap the child, close the pipes. Idempotent.

        A killed process needs the processor to die, and at our low priority it waits for that long beside
        others: one that is not dead after `patience_s` is left to the system, without its `usage`.
        """
        if self._ended is None:
            self.end_group()
            if patience_s is None or self._has_exited(patience_s):
                self._ended = ended = self._process.reap()
                peak_mb = ended.peak_memory / BYTES_PER_MB if self._peak_mb is None else self._peak_mb
                self.usage = Usage(self.age, ended.cpu_seconds, peak_mb)
        for end in (self._orders, self.channel):
            if end >= 0:
                os.close(end)
        self._orders = self.channel = -1
