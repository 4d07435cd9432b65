"""Child processes that work on one order each: new processes, or forks of a warm process.

A child that is forked from a warm process needs no imports and no compilation. The warm process starts with
the first child, which waits for it: that child would need the same imports by itself. Where a warm process
cannot be started, or is not ready in time, children are new processes.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from host.children.environment import child_environment
from host.children.fork_server import MESSAGE_BYTES, READY
from host.sessions import Ended, ending_signal, has_exited, reap

_FORK_SERVER = (sys.executable, "-P", "-m", "host.children.fork_server")
"""Command of a warm process. It is started without its starter's folder in the path, whose modules may be
another program's.
"""
MAX_FORKS = 500
"""Number of children of one warm process, which a new one then replaces."""
WARM_WITHIN_S = 10.0
"""Longest wait of a child for a warm process, s. An idle machine starts one in two seconds."""
_PATIENCE_S = 10.0
"""Longest wait for an answer of the warm process, s. It takes a hundredth of a second."""
UNSEEN = Ended(-9, 0.0, 0)
"""End of a child that could not be observed, because the warm process had ended before it."""
Warn: TypeAlias = Callable[..., object]
"""Function that is called as ``warn(event, **facts)``."""


class LauncherClosed(OSError):
    """The launcher is closed: it starts no child."""

    def __init__(self) -> None:
        super().__init__("the launcher is closed")


class Launcher:
    """Launches children that do ``work(descriptor)`` of a module, forked from a warm process where it can.

    One thread at a time calls `launch` and `warm_up`; any thread may call the other methods. A closed
    launcher starts no process until it is opened.

    Parameters
    ----------
    work : str
        Name of the module.
    modules : iterable of str
        Modules that the warm process imports.
    log : Path
        File that gets the standard output and error of the warm process.
    warn : callable
        Called when there is no warm process.
    """

    def __init__(self, work: str, modules: Iterable[str], log: Path, warn: Warn) -> None:
        self._modules, self._log, self._work, self._warn = sorted(set(modules)), log, work, warn
        self._server: WarmProcess | None = None
        self._waits, self._closed = True, False
        self._starting = threading.RLock()  # of whoever starts a process or closes; never while one waits

    def open(self) -> None:
        """Launch children again after `close`, and let them wait for a warm process again."""
        with self._starting:
            self._waits, self._closed = True, False

    def warm_up(self) -> None:
        """Start the warm process, if the system forks and there is none; return at once.

        Raises `LauncherClosed`.
        """
        with self._starting:
            self._require_open()
            server = self._server
            if sys.platform != "linux" or (server is not None and (server.usable or server.living)):
                return
            if server is not None:
                server.close()
            self._server = None
            try:
                self._server = WarmProcess(self._work, self._modules, self._log, self._warn)
            except OSError as error:
                self._warn("no warm process", reason=str(error))

    @property
    def warm(self) -> bool:
        """Whether the next child is forked."""
        with self._starting:
            return self._server is not None and self._server.ready

    def launch(self, ends: Ends, warm_within: float = WARM_WITHIN_S) -> ChildProcess:
        """Fork a child, or start one; OSError: the system does neither, or the launcher is closed."""
        self.warm_up()
        server = self._server
        if server is not None and server.usable and not self.warm:
            server.await_word(warm_within if self._waits else 0.0)
        with self._starting:
            self._require_open()
            if self._server is not None and self.warm:
                with contextlib.suppress(ConnectionError):
                    return self._server.fork(ends)
            return start_child(self._work, ends)

    def hurry(self) -> None:
        """Let no child wait for a warm process until `open` is called."""
        self._waits = False
        if (server := self._server) is not None:
            server.end_unless_ready()

    def close(self) -> None:
        """End the warm process and start no other; its children live on."""
        with self._starting:
            self._closed = True
            server, self._server = self._server, None
            if server is not None:
                server.close()

    def _require_open(self) -> None:
        if self._closed:
            raise LauncherClosed


@dataclass(frozen=True)
class Ends:
    """Resources of a child: descriptors for its orders, its answers and its log, and its folder."""

    orders: int
    channel: int
    log: int
    workspace: Path


@dataclass(frozen=True)
class _StartedChild:
    """A child that is a new process and leads its session: `pid` is also the id of group and session."""

    pid: int

    def has_exited(self) -> bool:
        """Whether it has ended. Until it is reaped no other process gets its id."""
        return has_exited(self.pid)

    def reap(self) -> Ended:
        return reap(self.pid)


def start_child(work: str, ends: Ends) -> _StartedChild:
    """Start a child that runs a module; OSError: the system does not."""
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", work, str(ends.channel)],
        stdin=ends.orders,
        stdout=ends.log,
        stderr=ends.log,
        pass_fds=(ends.channel,),
        start_new_session=True,
        env=child_environment(),
        cwd=ends.workspace,
    )
    process.returncode = 0  # `reap` waits for it, not Popen
    return _StartedChild(process.pid)


class WarmProcess:
    """The process that others are forked from, and the socket to it."""

    def __init__(self, work: str, modules: list[str], log: Path, warn: Warn) -> None:
        self.warn = warn
        self._channel, child_channel = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._channel.settimeout(_PATIENCE_S)
        self._ready, self._forks, self.living, self._gone = False, 0, 0, False
        self._asking = threading.Lock()  # threads of a Dask worker reap their children
        with child_channel, log.open("wb") as stream:
            try:
                self._process = subprocess.Popen(
                    [*_FORK_SERVER, str(child_channel.fileno()), work, *modules],
                    stdin=subprocess.DEVNULL,
                    stdout=stream,
                    stderr=stream,
                    pass_fds=(child_channel.fileno(),),
                    start_new_session=True,
                    env=child_environment(),
                )
            except OSError:
                self._channel.close()
                raise

    @property
    def usable(self) -> bool:
        """Whether it runs and may fork once more."""
        return not self._gone and self._forks < MAX_FORKS and self._process.poll() is None

    @property
    def ready(self) -> bool:
        """Whether the process has reported that it is warm, and may fork once more."""
        if not self._ready and self.usable:
            readable, _, _ = select.select([self._channel], [], [], 0.0)
            self._ready = bool(readable) and self._channel.recv(MESSAGE_BYTES) == READY
        return self._ready and self.usable

    def await_word(self, seconds: float) -> None:
        """Wait until the process reports that it is ready, or has ended; any thread may end it meanwhile."""
        with contextlib.suppress(OSError, ValueError):  # its end of the channel is closed
            select.select([self._channel], [], [], seconds)

    def fork(self, ends: Ends) -> _ForkedChild:
        """Fork a child; ConnectionError: the process is gone; OSError: the system forks no more."""
        descriptors = [ends.orders, ends.channel, ends.log]
        pid = self.ask({"workspace": str(ends.workspace)}, descriptors)
        if isinstance(pid, dict):
            raise OSError(pid["errno"], pid["strerror"])
        self._forks += 1
        self.living += 1
        return _ForkedChild(pid, os.pidfd_open(pid), self)

    def ask(self, request: dict[str, Any], descriptors: Iterable[int] = ()) -> Any:
        """Return the answer to a request; ConnectionError: the process is gone."""
        try:
            with self._asking:
                socket.send_fds(self._channel, [json.dumps(request).encode()], descriptors)
                answer = self._channel.recv(MESSAGE_BYTES)
        except OSError:
            answer = b""
        if not answer:
            self._gone = True
            raise ConnectionError
        return json.loads(answer)

    def end_unless_ready(self) -> None:
        """Kill the process while it warms up; any thread may call it."""
        if not self._ready:
            self._process.kill()

    def close(self) -> None:
        """End the process; its children live on."""
        self._process.kill()
        self._process.wait()
        self._channel.close()  # last: who waits for a word has seen the end of the process


@dataclass(frozen=True)
class _ForkedChild:
    """A child of the warm process; `handle` is a descriptor that becomes readable when it ends."""

    pid: int
    handle: int
    parent: WarmProcess

    def has_exited(self) -> bool:
        return bool(select.select([self.handle], [], [], 0.0)[0])

    def reap(self) -> Ended:
        """Wait for its end, and let its parent reap it."""
        select.select([self.handle], [], [])
        os.close(self.handle)
        self.parent.living -= 1
        try:
            return Ended(*self.parent.ask({"reap": self.pid}))
        except ConnectionError:
            self.parent.warn("warm process gone", pid=self.pid, signal=ending_signal(UNSEEN.code))
            return UNSEEN


ChildProcess: TypeAlias = _StartedChild | _ForkedChild
"""Child that leads a session. Its id stays reserved until it is reaped."""
Launch: TypeAlias = Callable[[Ends], ChildProcess]
