"""A child process that works on one order, however it came to be: started anew, or forked from a warm one."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from host import Ended, child_environment, has_exited, reap

WORK = "service.worker.child"
"""The module that works on orders."""


@dataclass(frozen=True)
class Ends:
    """What a child is given: descriptors of its ends of pipes and of its log, and where it works.

    Attributes
    ----------
    orders, channel, log : int
        It reads its order and renewals of its lease, writes progress and outcome, writes what it prints.
    workspace : Path
        Its working directory.
    """

    orders: int
    channel: int
    log: int
    workspace: Path


class ChildProcess(Protocol):
    """The leader of a session of its own."""

    @property
    def pid(self) -> int:
        """Process id, also of its group and session."""

    def has_exited(self) -> bool:
        """Whether it has ended. Until it is reaped no other process gets its id."""

    def reap(self) -> Ended:
        """Wait for its end."""


Launch = Callable[[Ends], ChildProcess]


@dataclass(frozen=True)
class StartedChild:
    """A child started anew."""

    pid: int

    def has_exited(self) -> bool:
        """Whether it has ended."""
        return has_exited(self.pid)

    def reap(self) -> Ended:
        """Wait for its end."""
        return reap(self.pid)


def start_child(ends: Ends, work: str = WORK) -> StartedChild:
    """Start a child that runs a module; OSError: the system does not."""
    process = subprocess.Popen(
        [sys.executable, "-m", work, str(ends.channel)],
        stdin=ends.orders,
        stdout=ends.log,
        stderr=ends.log,
        pass_fds=(ends.channel,),
        start_new_session=True,
        env=child_environment(),
        cwd=ends.workspace,
    )
    process.returncode = 0  # `reap` waits for it, not Popen
    return StartedChild(process.pid)
