"""The live worker seen from the service: start, ask, end."""

from __future__ import annotations

import contextlib
import os
import select
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

from host import child_environment, kill_group
from service.live.order import AnswerHead, LiveOrder
from service.own_folder import own_folder

_PIECE = 1 << 16


class WorkerGone(Exception):
    """The process ended, or did not answer in time."""

    def __init__(self, *, late: bool = False) -> None:
        super().__init__()
        self.late = late


class LiveWorker:
    """One child process that answers one order after the other, leader of a session of its own."""

    def __init__(self, log: Path, memory_limit_mb: int, home: Path) -> None:
        self._rest = b""
        self._folder = ExitStack()
        drafts = self._folder.enter_context(own_folder(home))
        self.has_answered = False
        self._channel, theirs = os.pipe()
        try:
            with log.open("wb") as stream:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "service.live.child", str(theirs), str(memory_limit_mb)],
                    stdin=subprocess.PIPE,
                    stdout=stream,
                    stderr=stream,
                    pass_fds=(theirs,),
                    start_new_session=True,
                    env=child_environment(TMPDIR=str(drafts)),
                )
        except OSError:
            os.close(self._channel)
            self._folder.close()
            raise
        finally:
            os.close(theirs)

    @property
    def pid(self) -> int:
        """Process id, also of its group and session."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process.poll() is None

    def ask(self, order: LiveOrder, limit_s: float) -> tuple[str, bytes]:
        """Return kind and bytes of the answer.

        Raises
        ------
        WorkerGone
            The process ended or took longer than `limit_s`; it is of no more use.
        """
        end = time.monotonic() + limit_s
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(order.line())
            self._process.stdin.flush()
        except BrokenPipeError:
            raise WorkerGone from None
        while b"\n" not in self._rest:
            self._rest += self._piece(end)
        line, _, self._rest = self._rest.partition(b"\n")
        head = AnswerHead.from_line(line)
        pieces, missing = [self._rest], head.length - len(self._rest)
        while missing > 0:
            pieces.append(self._piece(end))
            missing -= len(pieces[-1])
        body, self._rest = b"".join(pieces), b""
        self.has_answered = True
        return head.kind, body

    def _piece(self, end: float) -> bytes:
        """Return what comes next before the instant `end`."""
        ready, _, _ = select.select([self._channel], [], [], max(end - time.monotonic(), 0.0))
        if not ready:
            raise WorkerGone(late=True)
        piece = os.read(self._channel, _PIECE)
        if not piece:
            raise WorkerGone
        return piece

    def end_group(self) -> None:
        """Kill the process and what it started; whoever asks it is told that it is gone. Any thread may."""
        if self._process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                kill_group(self.pid)

    def close(self) -> None:
        """Kill, reap, close the pipes; by the thread that asks. Idempotent."""
        self.end_group()
        self._process.wait()
        self._folder.close()
        if self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        if self._channel >= 0:
            os.close(self._channel)
            self._channel = -1
