"""Scenes one after the other in a child process: a crash or a hang ends one scene, not the suite."""

from __future__ import annotations

import multiprocessing
import signal
import time
import warnings
from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from bounds import PlausibilityWarning
from host import kill_group, lead_session
from lineofaction.hardcases.scene import HardScene, Outcome

_START_LIMIT = 120.0  # seconds for a new process to import what it needs


def run_scenes(scenes: Sequence[HardScene]) -> Iterator[Outcome]:
    """Yield the outcome of each scene, also of a scene that crashes or hangs.

    One process runs them all, so that modules are imported and compiled once. After a scene that ends the
    process, or does not end, a new process runs the next ones.
    """
    worker: _Worker | None = None
    try:
        for scene in scenes:
            worker = worker or _Worker()
            outcome = worker.run(scene)
            if outcome.ended_by and not worker.alive:
                worker = None
            yield outcome
    finally:
        if worker is not None:
            worker.stop()


class _Worker:
    """The child process, and its pipe."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, child_pipe = context.Pipe()
        self._process: BaseProcess = context.Process(target=_serve, args=(child_pipe,), daemon=False)
        self._process.start()
        child_pipe.close()
        self.alive = self._pipe.poll(_START_LIMIT) and bool(self._pipe.recv())

    def run(self, scene: HardScene) -> Outcome:
        """Send one scene and wait for it, no longer than its limit."""
        begin = time.perf_counter()
        try:
            self._pipe.send(scene)
            if self._pipe.poll(scene.time_limit):
                outcome: Outcome = self._pipe.recv()
                return outcome
            ended_by = f"not done after its limit of {scene.time_limit:g} s"
        except (EOFError, BrokenPipeError, ConnectionResetError):
            self._process.join()
            ended_by = f"its process ended with code {self._process.exitcode}"
        self.stop()
        return Outcome(scene, (), time.perf_counter() - begin, ended_by)

    def stop(self) -> None:
        """End the process and all that it started."""
        self.alive = False
        try:
            kill_group(self._process.pid or 0)
        except (ProcessLookupError, PermissionError):
            self._process.kill()
        self._process.join()
        self._pipe.close()


def _serve(pipe: Connection) -> None:
    """Run the scenes that come, until the pipe closes."""
    lead_session()  # so that a mesher it started ends with it
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("error")  # a warning is a fault here, unless it says that the input is odd
    warnings.simplefilter("ignore", PlausibilityWarning)
    pipe.send(True)
    while True:
        try:
            scene: HardScene = pipe.recv()
        except EOFError:
            return
        pipe.send(_outcome(scene))


def _outcome(scene: HardScene) -> Outcome:
    begin = time.perf_counter()
    try:
        return scene.run()
    except Exception as error:  # noqa: BLE001 (the suite goes on; the scene has failed and says how)
        return Outcome(scene, (), time.perf_counter() - begin, f"{type(error).__name__}: {error}")
