"""A worker process seen from the service: start, listen, end.

A worker is a child process with a process group of its own. It sends messages through a channel: that it has
begun, progress, warnings, and its outcome.
"""

from __future__ import annotations

import time
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from fe_contact.cache_reads import CacheReads
from host import ending_signal, family_cpu_seconds
from host.children.child import Child
from host.children.frames import Frame
from host.children.launcher import Launch, start_child
from service.worker.order import Outcome, Product, WorkOrder
from service.worker.usage import BYTES_PER_MB, Usage

WORK = "service.worker.child"
"""The module whose function `work` a child executes."""
_NEW_PROCESS = partial(start_child, WORK)
_LEAVING_S = 2.0
"""Time in s that a child has for its exit after its last message; then its group is killed."""
_SIGNALS_OF_LITTLE_MEMORY = ("SIGKILL", "SIGABRT")
"""Signals that may mean too little memory: SIGKILL by the system, SIGABRT by a library that cannot go on."""


class Step(NamedTuple):
    """Progress of a worker."""

    stage: str
    fraction: float
    """Completed fraction of the stage, 0 to 1."""
    whole: float | None
    """Completed fraction of the whole order, 0 to 1; None: unknown."""
    at: float
    """Time of the report, s since 1970."""
    cpu_s: float
    """CPU time of the child until then, s, with the processes that it has waited for."""


class Worker:
    """One child process for one order; `begun` is True from its first message."""

    def __init__(self, order: WorkOrder, log: Path, launch: Launch = _NEW_PROCESS) -> None:
        self.started = time.monotonic()
        self.usage: Usage | None = None
        self.compliance_reads = CacheReads()
        self.warnings: list[str] = []
        self.begun = False
        self._outcome: Outcome | None = None
        self._peak_mb: float | None = None
        with log.open("wb") as stream:
            self._child = Child(launch, stream.fileno(), order.workspace)
        self._child.send(Frame("order", order.line()))  # no error for a dead child: its closed channel tells

    @property
    def pid(self) -> int:
        """Process id, also of its group and session."""
        return self._child.pid

    @property
    def channel(self) -> int:
        """Descriptor that becomes readable when the worker has sent something."""
        return self._child.channel

    @property
    def age(self) -> float:
        """Seconds since the start."""
        return time.monotonic() - self.started

    @property
    def log_fields(self) -> dict[str, Any]:
        """The fields that name the worker in the log."""
        return {"pid": self.pid}

    def spent(self) -> float | None:
        """Return the CPU seconds of the child and its children so far; None: it has ended."""
        return family_cpu_seconds(self.pid)

    def listen(self) -> tuple[list[Step], bool]:
        """Return the progress since the last call, and whether the child closed its channel."""
        steps = []
        for frame in self._child.receive():
            if frame.kind == "step":
                steps.append(Step(**frame.as_json()))
            else:
                self._take(frame.kind, frame.as_json())
        return steps, self._child.closed

    def _take(self, kind: str, content: Any) -> None:
        """Handle a message that is not progress: begin, warning or outcome."""
        if kind == "begun":
            self.begun = True
        elif kind == "warning":
            self.warnings.append(content)
        elif kind == "outcome":
            self._peak_mb = content["peak_mb"]
            self.compliance_reads = CacheReads(**content["compliance_reads"])
            self._outcome = _outcome(content)

    def finish(self) -> Outcome:
        """End the process group, reap the child and return how it ended.

        An order is executed again after a child that is lost, which counts as no attempt, or has died.
        """
        self._child.exits_within(_LEAVING_S)  # waits for a child that ends by itself
        self.kill()
        if self._outcome is not None:
            return self._outcome
        assert self._child.ended is not None
        signal = ending_signal(self._child.ended.code)
        if self.begun and self._child.killed_from_outside:
            return Outcome(failure=f"The worker was ended by {signal} from outside the service.", lost=True)
        text = f"The worker ended early with exit code {self._child.ended.code}."
        if signal:
            hint = " (it may have run out of memory)" if signal in _SIGNALS_OF_LITTLE_MEMORY else ""
            text = f"The worker was ended by {signal}{hint}."
        return Outcome(failure=text, died=self.begun, lost=not self.begun)

    def end_group(self) -> None:
        """Send the group (gmsh's process included) SIGKILL."""
        self._child.end_group()

    def kill(self, patience_s: float | None = None) -> None:
        """Kill the group, reap the child, close the pipes. Idempotent.

        A child that is not dead after `patience_s` is left to the system, and `usage` stays None.
        """
        ended = self._child.end(patience_s)
        if ended is not None and self.usage is None:
            peak_mb = ended.peak_memory / BYTES_PER_MB if self._peak_mb is None else self._peak_mb
            self.usage = Usage(self.age, ended.cpu_seconds, peak_mb)


def _outcome(content: dict[str, Any]) -> Outcome:
    """Return the outcome that a child reports."""
    products = tuple(Product(**p | {"file": Path(p["file"])}) for p in content.get("products", ()))
    end = {name: content[name] for name in ("failure", "unexpected") if name in content}
    return Outcome(products=products, faults=tuple(content.get("faults", ())), **end)
