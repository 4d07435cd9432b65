"""A Dask scheduler and workers in processes of their own, as an operator starts them."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from socket import create_connection, create_server
from typing import Any

from running_service import PATIENCE_S, lives, until

import host

_DASK = [sys.executable, "-m", "dask"]


@dataclass
class DaskProcesses:
    """What runs; `environment` is that of workers."""

    folder: Path
    environment: dict[str, str]
    port: int = 0
    scheduler: subprocess.Popen[bytes] | None = None
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @property
    def address(self) -> str:
        return f"tcp://127.0.0.1:{self.port}"

    def start_scheduler(self) -> None:
        if self.port == 0:
            with closing(create_server(("127.0.0.1", 0))) as free:
                self.port = free.getsockname()[1]
        words = ["scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard"]
        self.scheduler = self._started(words, "scheduler")
        until(self._listens)

    def _listens(self) -> bool:
        with suppress(ConnectionRefusedError):
            create_connection(("127.0.0.1", self.port)).close()
            return True
        return False

    def start_workers(
        self, number: int = 1, *, nanny: bool = True, preload: str = "", **environment: str
    ) -> None:
        words = ["worker", self.address, "--nthreads", "1", "--nworkers", str(number), "--no-dashboard"]
        words += ["--local-directory", str(self.folder / "dask")]
        words += [] if nanny else ["--no-nanny"]
        words += ["--preload", preload] if preload else []
        self.workers.append(self._started(words, f"worker_{len(self.workers)}", **environment))

    def _started(self, words: list[str], name: str, **more: str) -> subprocess.Popen[bytes]:
        environment = {**os.environ, **self.environment, **more}
        with (self.folder / f"{name}.log").open("ab") as log:
            return subprocess.Popen(
                [*_DASK, *words], env=environment, stdout=log, stderr=log, start_new_session=True
            )

    def run(self, function: Any) -> dict[str, Any]:
        """Call a function in all workers; return its answers by their addresses."""
        from distributed import Client  # noqa: PLC0415 (an extra)

        with Client(self.address, set_as_default=False) as client:
            found: dict[str, Any] = client.run(function)
        return found

    def pids(self) -> list[int]:
        """Return the processes of the workers."""
        return list(self.run(os.getpid).values())

    def results(self) -> list[str]:
        """Return the names of the tasks that are kept for a server."""
        from distributed import Client  # noqa: PLC0415 (an extra)

        with Client(self.address, set_as_default=False) as client:
            return list(map(str, client.list_datasets()))

    def await_workers(self, number: int) -> None:
        from distributed import Client  # noqa: PLC0415 (an extra)

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(number, timeout=PATIENCE_S)

    def kill_worker(self) -> None:
        """Kill one worker; its nanny starts another."""
        os.kill(self.pids()[0], signal.SIGKILL)

    def fall_and_rise(self) -> None:
        """Kill the scheduler, with which the workers end, and start all again, as supervisors do."""
        number = len(self.pids())
        self.end_scheduler()
        self.end_workers()
        self.start_scheduler()
        self.start_workers(number)

    def end_scheduler(self) -> None:
        self.scheduler.kill()
        self.scheduler.wait()

    def end_workers(self) -> None:
        for worker in self.workers:
            if worker.poll() is None:
                os.killpg(worker.pid, signal.SIGKILL)
            worker.wait()
        self.workers.clear()
        until(lambda: not any(lives(pid) for pid in host.processes_in(self.folder / "dask")))

    def close(self) -> None:
        self.end_workers()
        if self.scheduler is not None:
            self.end_scheduler()


@contextmanager
def dask_processes(folder: Path, workers: int, **environment: str) -> Iterator[DaskProcesses]:
    """Start a scheduler with workers, each with one thread, that find the fakes."""
    fakes = str(Path(__file__).resolve().parent)
    path = os.pathsep.join([fakes, str(Path(__file__).resolve().parents[2])])
    made = DaskProcesses(folder, {"PYTHONPATH": path, **environment})
    try:
        made.start_scheduler()
        if workers:
            made.start_workers(workers)
            made.await_workers(workers)
        yield made
    finally:
        made.close()
