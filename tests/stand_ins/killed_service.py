"""A service of several processes whose parts are killed at random moments, watched from outside."""

from __future__ import annotations

import hashlib
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
from running_service import REFERENCES, until
from service_stand_in_work import slow_content

EXECUTION = "/v1/processes/standin/execution"
FILE = {"Accept": "application/x-netcdf"}
PATIENCE_S = 600.0  # many times what a quiet machine needs: a hang, not a speed, is what this finds
_MARK = "LOA_TEST_MARK"
_BACKLOG = 3
_LOST = (httpx2.TransportError, ConnectionError)
_ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Part:
    """One process of the service, started anew whenever it was killed."""

    role: str
    environment: Mapping[str, str]
    log: Path
    descriptor: int | None = None
    process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it."""
        script = str(Path(__file__).with_name("stand_in_process.py"))
        listener = [] if self.descriptor is None else [str(self.descriptor)]
        fds = () if self.descriptor is None else (self.descriptor,)
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                [sys.executable, script, self.role, *listener],
                env=self.environment,
                stdout=log,
                stderr=log,
                pass_fds=fds,
            )

    def heeds_stops(self) -> bool:
        """Whether it has come so far that it handles SIGTERM: one killed a moment ago may be starting."""
        assert self.process is not None
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        caught = int(status.partition("SigCgt:")[2].split()[0], 16)
        return bool(caught >> (signal.SIGTERM - 1) & 1)

    def end(self, number: signal.Signals) -> int:
        """Send a signal and wait."""
        assert self.process is not None
        self.process.send_signal(number)
        return self.process.wait(timeout=30)


@dataclass
class KilledService:
    """The service, its victims and its witness.

    Attributes
    ----------
    directory : Path
    settings : dict
        Environment of all parts.
    end_connections : callable or None
        Ends all connections to the database; None: there are none to end.
    apart : bool
        One process that serves and two that work, instead of one that does both.
    """

    directory: Path
    settings: dict[str, str]
    end_connections: Callable[[], int] | None
    apart: bool
    parts: list[Part] = field(default_factory=list)
    jobs: dict[str, str] = field(default_factory=dict)
    served: dict[str, set[str]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    struck: list[str] = field(default_factory=list)
    span: float = 1.0
    mark: str = field(default_factory=lambda: uuid.uuid4().hex)

    def __enter__(self) -> KilledService:
        self._listener = socket.socket()
        self._listener.bind(("127.0.0.1", 0))
        self._listener.listen(256)
        self._listener.set_inheritable(True)
        self.address = f"http://127.0.0.1:{self._listener.getsockname()[1]}"
        roles = ["serve", "work", "work"] if self.apart else ["all"]
        for number, role in enumerate(roles):
            place = self.directory / (f"part_{number}" if self.apart else "part")
            descriptor = None if role == "work" else self._listener.fileno()
            environment = {**os.environ, **self.settings, _MARK: self.mark, "LOA_DATA_DIRECTORY": str(place)}
            environment["PYTHONPATH"] = os.pathsep.join([str(_ROOT), os.environ["PYTHONPATH"]])
            self.parts.append(Part(role, environment, self.directory / f"{role}_{number}.log", descriptor))
        for part in self.parts:
            part.start()
        self._client = httpx2.Client(base_url=self.address, timeout=30.0)
        self._stop = threading.Event()
        self._witness = threading.Thread(target=self._look)
        self._witness.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._witness.join()
        self._client.close()
        for part in self.parts:
            if part.process is not None and part.process.poll() is None:
                part.process.kill()
                part.process.wait()
        self._listener.close()

    def request(self, method: str, path: str, **more: Any) -> httpx2.Response:
        """Ask until there is an answer, as the client does."""
        end = time.monotonic() + PATIENCE_S
        while True:
            with suppress(*_LOST):
                answer = self._client.request(method, path, **more)
                if answer.status_code != 503:
                    return answer
            assert time.monotonic() < end, f"no answer to {method} {path}"
            time.sleep(0.05)

    def submit(self, text: str) -> None:
        """Enter a job."""
        answer = self.request("POST", EXECUTION, json={"inputs": {"wish": {"mode": "slow", "text": text}}})
        assert answer.status_code == 201, answer.text
        self.jobs[answer.json()["jobID"]] = text

    def measure(self, text: str) -> None:
        """Run a job undisturbed: moments are chosen from somewhat more than its duration."""
        self.submit(text)
        began = time.monotonic()
        self.settled()
        self.span = time.monotonic() - began

    def strike(self, chance: random.Random) -> None:
        """Wait for a worker with little else to do, for a random while, and kill something at random.

        Where nothing is left to do, an idle part is killed.
        """
        until(self._can_be_struck, PATIENCE_S)
        victims = ["worker", *(part.role for part in self.parts)]
        victims += [] if self.end_connections is None else ["database"] * 2
        victim = chance.choice(victims)
        time.sleep(chance.uniform(0.0, 1.2 * self.span))
        self.struck.append(victim)
        if victim == "database":
            assert self.end_connections is not None
            self.end_connections()
        elif victim == "worker":
            for pid in self._workers()[:1]:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
        else:
            part = chance.choice([part for part in self.parts if part.role == victim])
            part.end(signal.SIGKILL)
            part.start()

    def _can_be_struck(self) -> bool:
        """Whether there is a worker and little else to do, or nothing."""
        unfinished = self._unfinished()
        return unfinished == 0 or (unfinished <= _BACKLOG and self._workers() != [])

    def _unfinished(self) -> int:
        """Return how many computations wait or run."""
        counts = self.request("GET", "/ready").json()["computations"]
        return int(counts.get("accepted", 0) + counts.get("running", 0))

    def marked(self) -> list[int]:
        """Return the processes of this service that live, zombies apart."""
        found = []
        for entry in Path("/proc").iterdir():
            with suppress(OSError):
                if entry.name.isdigit() and self.mark.encode() in (entry / "environ").read_bytes():
                    found.append(int(entry.name))
        return found

    def _workers(self) -> list[int]:
        """Return the processes that do stand-in work."""
        found = []
        for pid in self.marked():
            with suppress(OSError):
                if b"service.jobs.child" in Path(f"/proc/{pid}/cmdline").read_bytes():
                    found.append(pid)
        return found

    def _look(self) -> None:
        """Fetch all results all the time, and note whatever is not a whole and right one."""
        with httpx2.Client(base_url=self.address, timeout=30.0) as client:
            while not self._stop.wait(0.2):
                for job, text in list(self.jobs.items()):
                    with suppress(*_LOST):
                        self._look_at(client, job, text)

    def _look_at(self, client: httpx2.Client, job: str, text: str) -> None:
        """Fetch one result."""
        status = client.get(f"/v1/jobs/{job}/results", params=REFERENCES)
        if status.status_code != 200:
            if status.status_code not in (404, 503):
                self.faults.append(f"job {job}: {status.status_code} {status.text}")
            return
        answer = client.get(status.json()["database"]["href"], headers=FILE)
        if answer.status_code == 200:
            self.served.setdefault(text, set()).add(hashlib.sha256(answer.content).hexdigest())
            if answer.content != slow_content(text):
                self.faults.append(f"{text}: {len(answer.content)} bytes, not its result")
        elif answer.status_code != 503:
            self.faults.append(f"{text}: {answer.status_code} {answer.text}")

    def settled(self) -> dict[str, str]:
        """Wait until every job has ended; return their ends."""
        ends: dict[str, str] = {}
        for job in self.jobs:
            until(lambda job=job: self._ended(job, ends), PATIENCE_S)  # type: ignore[misc]
        return ends

    def _ended(self, job: str, ends: dict[str, str]) -> bool:
        """Note how a job ended, if it has."""
        state = self.request("GET", f"/v1/jobs/{job}").json()
        ends[job] = state["status"]
        return state["status"] in ("successful", "failed", "dismissed")

    def stop(self) -> list[int]:
        """Stop all parts as a supervisor does; return their exit codes."""
        self._stop.set()
        self._witness.join()
        for part in self.parts:
            until(part.heeds_stops, PATIENCE_S)
        return [part.end(signal.SIGTERM) for part in self.parts]
