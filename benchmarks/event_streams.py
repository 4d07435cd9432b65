"""CPU time of a service whose 200 event streams follow two jobs, over that without streams.

The jobs are entered and reported on by this process, so that the service serves only. The database is SQLite,
or that of ``LOA_DATABASE_URL`` (upgraded, empty).
"""

from __future__ import annotations

import socket
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from statistics import median

from benchmarks.figures import Figure
from benchmarks.service_process import cpu_seconds, memory_mb, running
from lineofaction.gearbox.subjects import case_inputs
from service.page.files import examples
from service.queue.claims import Claims, Reached
from service.queue.scheduler import Machinery, job_machinery
from service.settings import load_settings
from service.worker.process import ANALYZE, default_registry

STREAMS, REPORTS_PER_S, SECONDS, ROUNDS = 200, 2.0, 5.0, 3


class _Jobs:
    """Two jobs that run by the table, claimed before the service looks at it, and how far they are."""

    def __init__(self, machinery: Machinery) -> None:
        self._claims, self._step = Claims(machinery.engine), 0
        self.names = []
        for torque in (100.0, 200.0):
            inputs = case_inputs({**examples()[0].content, "load": {"torque_n_m": [50.0, torque]}})
            job = machinery.submissions.submit(ANALYZE.id, ANALYZE.key(inputs), inputs, stored=False)
            self.names.append(job.id)
        self._claimed = [claim for claim in (self._claims.claim() for _ in self.names) if claim is not None]

    def report(self) -> None:
        """Report on both."""
        self._step += 1
        reached = Reached("contact", min(1e-4 * self._step, 1.0), min(1e-4 * self._step, 0.99))
        self._claims.progress([(claim, reached) for claim in self._claimed])


def figures() -> list[Figure]:
    """Compare rounds without and with streams, in alternation."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        directory = Path(folder)
        address, process, _ = stack.enter_context(running(directory))
        machinery = job_machinery(load_settings(data_directory=directory), default_registry(), works=False)
        jobs = _Jobs(stack.enter_context(closing(machinery)))
        port = int(address.rpartition(":")[2])
        time.sleep(10.0)  # the service has loaded its libraries
        alone, listened, delays = [], [], list[float]()
        for _ in range(ROUNDS):
            alone.append(_cores(process.pid, jobs, []))
            with _streams(port, jobs.names) as streams:
                listened.append(_cores(process.pid, jobs, delays, streams))
        memory = memory_mb(process.pid)
    subject = f"{STREAMS} event streams of 2 jobs, {2 * REPORTS_PER_S:g} reports a second"
    return [
        Figure(subject, "cores of the service without streams", median(alone), "cores"),
        Figure(subject, "cores that the streams add", median(listened) - median(alone), "cores", 0.1),
        Figure(subject, "from a report until all streams have it, median", 1e3 * median(delays), "ms", 500.0),
        Figure(subject, "memory of the service", memory, "MB"),
    ]


def _cores(pid: int, jobs: _Jobs, delays: list[float], streams: list[_Stream] | None = None) -> float:
    """Report for a while; return the CPU time of the service over that while."""
    begin, cpu = time.perf_counter(), cpu_seconds(pid)
    while (now := time.perf_counter()) < begin + SECONDS:
        before = [each.events for each in streams or []]
        jobs.report()
        if streams:
            while any(each.events <= count for each, count in zip(streams, before, strict=True)):
                time.sleep(0.005)
            delays.append(time.perf_counter() - now)
        time.sleep(max(now + 1.0 / REPORTS_PER_S - time.perf_counter(), 0.0))
    return (cpu_seconds(pid) - cpu) / (time.perf_counter() - begin)


class _Stream:
    """One stream, read by a thread; its events are counted."""

    def __init__(self, port: int, job: str) -> None:
        self.events = 0
        self._socket = socket.create_connection(("127.0.0.1", port))
        head = f"GET /v1/jobs/{job}/events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n"
        self._socket.sendall(head.encode())
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        """Count events until the stream is closed."""
        while piece := self._socket.recv(65536):
            self.events += piece.count(b"event: status")

    def close(self) -> None:
        """Leave."""
        self._socket.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._socket.close()


@contextmanager
def _streams(port: int, names: list[str]) -> Iterator[list[_Stream]]:
    """Open the streams, half of them for each job, and wait for their first events."""
    with ExitStack() as stack:
        streams = [stack.enter_context(closing(_Stream(port, names[n % 2]))) for n in range(STREAMS)]
        end = time.perf_counter() + 60.0
        while not all(each.events for each in streams):
            if time.perf_counter() > end:
                raise RuntimeError("a stream has no first event")
            time.sleep(0.01)
        yield streams
