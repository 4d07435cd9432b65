"""A worker process seen from the service: start, listen, end."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import structlog

from host import ending_signal, has_exited, kill_group, never_wait_at, reap
from service.worker.order import Outcome, Product, WorkOrder
from service.worker.usage import BYTES_PER_MB, Usage

logger = structlog.get_logger(__name__)

_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
_LEAVING_S = 2.0
_OF_LITTLE_MEMORY = ("SIGKILL", "SIGABRT")  # by the system, and by libraries that cannot go on
_ROOT = str(Path(__file__).resolve().parents[2])


def child_environment() -> dict[str, str]:
    """Environment of the child: one thread, and the code we run ourselves, installed or not."""
    path = os.pathsep.join(part for part in (_ROOT, os.environ.get("PYTHONPATH", "")) if part)
    return {**os.environ, **_ONE_THREAD, "PYTHONPATH": path}


class Worker:
    """One child process for one order, leader of a session of its own."""

    def __init__(self, order: WorkOrder, log: Path) -> None:
        self.started = time.monotonic()
        self.usage: Usage | None = None
        self._outcome: Outcome | None = None
        self._peak_mb: float | None = None
        self._rest = b""
        self._giving = threading.Lock()
        self.channel, theirs = os.pipe()
        never_wait_at(self.channel)
        try:
            with log.open("wb") as stream:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "service.worker.child", str(theirs)],
                    stdin=subprocess.PIPE,
                    stdout=stream,
                    stderr=stream,
                    pass_fds=(theirs,),
                    start_new_session=True,
                    env=child_environment(),
                    cwd=order.workspace,
                )
        except OSError:
            os.close(self.channel)
            raise
        finally:
            os.close(theirs)
        self._give(order)

    def _give(self, order: WorkOrder) -> None:
        """Write the order; a child that died before reading it shows when its channel ends."""
        stream = self._process.stdin
        assert stream is not None
        with contextlib.suppress(BrokenPipeError):
            stream.write(order.line())
            stream.flush()
        never_wait_at(stream.fileno())

    @property
    def pid(self) -> int:
        """Process id, also of its group and session."""
        return self._process.pid

    @property
    def age(self) -> float:
        """Seconds since the start."""
        return time.monotonic() - self.started

    def beat(self, until: float) -> None:
        """Tell the child until when its lease was renewed; it ends itself at that instant."""
        with self._giving, contextlib.suppress(BrokenPipeError, BlockingIOError):
            if self._process.stdin is not None and not self._process.stdin.closed:
                os.write(self._process.stdin.fileno(), b"%r\n" % until)

    def listen(self) -> tuple[list[tuple[str, float]], bool]:
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

    def _taken(self, message: dict[str, Any]) -> tuple[str, float] | None:
        """Return a message as progress, or keep it as the outcome."""
        if "stage" in message:
            return message["stage"], message["fraction"]
        if "warning" in message:
            logger.warning("worker warns", pid=self.pid, reason=message["warning"])
            return None
        self._peak_mb = message.get("peak_mb")
        products = tuple(Product(p["key"], p["kind"], Path(p["file"])) for p in message.get("products", ()))
        facts = {name: message[name] for name in ("failure", "unexpected") if name in message}
        self._outcome = Outcome(products=products, faults=tuple(message.get("faults", ())), **facts)
        return None

    def finish(self) -> Outcome:
        """End the process group, reap the child and return how it ended."""
        self._has_exited(_LEAVING_S)
        self.kill()
        if self._outcome is not None:
            return self._outcome
        return Outcome(failure=_cause(self._process.returncode), died=True)

    def _has_exited(self, patience_s: float) -> bool:
        """Whether the child leaves within a moment; do not reap it yet.

        Until it is reaped its process id, which is also its group's, cannot be given to another.
        """
        deadline = time.monotonic() + patience_s
        while not has_exited(self.pid):
            if time.monotonic() > deadline:
                return False
            time.sleep(0.005)
        return True

    def end_group(self) -> None:
        """Send the group (gmsh's process included) SIGKILL."""
        if self._process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                kill_group(self.pid)

    def kill(self, patience_s: float | None = None) -> None:
        """Kill the group, reap the child, close the pipes. Idempotent.

        A killed process needs the processor to die, and at our low priority it waits for that long beside
        others: one that is not dead after `patience_s` is left to the system, without its `usage`.
        """
        if self._process.returncode is None:
            self.end_group()
            if patience_s is None or self._has_exited(patience_s):
                self._reap()
        if self._process.stdin is not None:
            with self._giving, contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        if self.channel >= 0:
            os.close(self.channel)
            self.channel = -1

    def _reap(self) -> None:
        """Wait for the child's end, and note what it took."""
        ended = reap(self.pid)
        self._process.returncode = ended.code
        peak_mb = ended.peak_memory / BYTES_PER_MB if self._peak_mb is None else self._peak_mb
        self.usage = Usage(self.age, ended.cpu_seconds, peak_mb)


def _cause(code: int) -> str:
    """Return why a worker ended without an outcome."""
    if name := ending_signal(code):
        hint = " (it may have run out of memory)" if name in _OF_LITTLE_MEMORY else ""
        return f"The worker was ended by {name}{hint}."
    return f"The worker ended early with exit code {code}."
