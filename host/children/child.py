"""A child process as its starter sees it: orders go there, answers come back, and its end has a reason."""

from __future__ import annotations

import contextlib
import math
import os
import select
import threading
import time
from pathlib import Path

from host.children.frames import Frame, FrameBuffer
from host.children.launcher import UNSEEN, Ends, Launch
from host.memory_kills import memory_kills
from host.sessions import Ended, ending_signal, kill_group, never_wait_at

_PIECE = 1 << 16
"""Bytes of one read: the capacity of a pipe of Linux."""
_MAX_PIECES = 16
"""Reads of one look, so that a child that never rests does not keep its starter from others."""
_POLL_S = 0.001


class Child:
    """One child process, the leader of a session of its own; what it starts ends with it.

    It is for one thread, but for `end_group`.

    Parameters
    ----------
    launch : callable
        Starts or forks the process.
    log : int
        Descriptor of the file that gets its standard output and error.
    workspace : Path
        Where it works.

    Raises OSError: the system starts no process.
    """

    def __init__(self, launch: Launch, log: int, workspace: Path) -> None:
        self._frames = FrameBuffer()
        self._ended: Ended | None = None
        self._was_killed = False
        self._reaping = threading.Lock()  # until a child is reaped, no other process has its id
        self._kills_before = memory_kills()
        self.closed = False
        """Whether the child has closed its end of the channel."""
        orders_end, self._orders = os.pipe()
        self.channel, answers_end = os.pipe()
        never_wait_at(self.channel)
        try:
            self._process = launch(Ends(orders_end, answers_end, log, workspace))
        except OSError:
            self._close_pipes()
            raise
        finally:
            os.close(orders_end)
            os.close(answers_end)

    @property
    def pid(self) -> int:
        """Process id of the child, also the id of its group and session."""
        return self._process.pid

    @property
    def received(self) -> int:
        """Bytes that it has sent so far."""
        return self._frames.received

    @property
    def partial(self) -> bool:
        """Whether the last bytes that it sent are not, or not yet, a whole frame."""
        return self._frames.partial

    def send(self, order: Frame) -> bool:
        """Send an order; return whether there is somebody to read it."""
        with contextlib.suppress(BrokenPipeError):
            with os.fdopen(self._orders, "wb", closefd=False) as stream:
                order.write(stream)
            return True
        return False

    def receive(self, within_s: float = 0.0) -> list[Frame]:
        """Return the frames that are complete, after a wait for the next bytes or for the end of them."""
        poll = select.poll()
        poll.register(self.channel, select.POLLIN)
        frames: list[Frame] = []
        if not poll.poll(math.ceil(1e3 * within_s)):
            return frames
        for _ in range(_MAX_PIECES):
            try:
                piece = os.read(self.channel, _PIECE)
            except BlockingIOError:
                break
            if not piece:
                self.closed = True
                break
            frames += self._frames.take(piece)
        return frames

    def exits_within(self, within_s: float) -> bool:
        """Wait for its end; return whether it came. Until it is reaped its id is given to no other group."""
        if self._ended is not None:
            return True
        deadline = time.monotonic() + within_s
        while not self._process.has_exited():
            if time.monotonic() >= deadline:
                return False
            time.sleep(_POLL_S)
        return True

    def end_group(self) -> None:
        """Kill the child and the processes that it started, unless it has been reaped. Any thread may."""
        with self._reaping:
            if self._ended is None:
                self._was_killed = self._was_killed or not self._process.has_exited()
                with contextlib.suppress(ProcessLookupError):
                    kill_group(self.pid)

    def end(self, within_s: float | None = None) -> Ended | None:
        """Kill the group, close the pipes, and return how the child ended; None: it is not dead in time.

        A killed process needs the processor to die. At a low priority it may wait long for the processor: a
        child that is not dead after `within_s` is left to the system. `within_s` None waits until it is dead.
        """
        self.end_group()
        if self._ended is None and (within_s is None or self.exits_within(within_s)):
            with self._reaping:
                self._ended = self._process.reap()
        self._close_pipes()
        return self._ended

    @property
    def ended(self) -> Ended | None:
        """Exit code and cost of the child, if it was reaped; else None."""
        return self._ended

    @property
    def killed_from_outside(self) -> bool:
        """Whether neither its starter nor the system, for lack of memory, sent the SIGKILL that ended it.

        False where the system does not count the processes that it kills for lack of memory, and where it
        killed any since the start.
        """
        # UNSEEN: the warm process that could have observed the end of the child had ended before it.
        if self._ended is None or self._ended is UNSEEN or self._was_killed:
            return False
        killed = ending_signal(self._ended.code) == "SIGKILL"
        return killed and self._kills_before is not None and memory_kills() == self._kills_before

    def _close_pipes(self) -> None:
        for descriptor in (self._orders, self.channel):
            if descriptor >= 0:
                os.close(descriptor)
        self._orders = self.channel = -1
