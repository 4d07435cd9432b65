"""A service whose parts are killed while it works: its processes, its victims, a witness of its results."""

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
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
from running_service import PATIENCE_S, REFERENCES, lives, until
from service_fake_work import is_slow_content

from host import processes_in


@dataclass
class Part:
    """A server on a socket; `revived` counts starts after it had ended by itself."""

    environment: Mapping[str, str]
    log: Path
    descriptor: int
    process: subprocess.Popen[bytes] | None = None
    revived: int = 0

    def start(self) -> None:
        script = str(Path(__file__).with_name("fake_process.py"))
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                [sys.executable, script, str(self.descriptor)],
                env=self.environment,
                stdout=log,
                stderr=log,
                pass_fds=(self.descriptor,),
            )

    def revive(self) -> None:
        """Start it again if it has ended, as a supervisor does."""
        if self.process is not None and self.process.poll() is not None:
            self.revived += 1
            self.start()

    @property
    def pid(self) -> int:
        return self.process.pid

    def heeds_stops(self) -> bool:
        """Whether it has come so far that it handles SIGTERM: one killed a moment ago may be starting."""
        status = Path(f"/proc/{self.pid}/status").read_text()
        caught = int(status.partition("SigCgt:")[2].split()[0], 16)
        return bool(caught >> (signal.SIGTERM - 1) & 1)

    def end(self, number: signal.Signals) -> int:
        self.process.send_signal(number)
        return self.process.wait(timeout=PATIENCE_S)


FILE = {"Accept": "application/x-netcdf"}
LOST = (httpx2.TransportError, ConnectionError)
_AT_ONCE = 10  # of those that were seen before


class Witness:
    """Looks at the results of jobs (the text of the wish by job; may grow meanwhile).

    `served` are digests by text, one each if all is well; `faults` is what should not have been.
    """

    def __init__(self, address: str, jobs: Mapping[str, str], headers: Mapping[str, str]) -> None:
        self._address, self._jobs, self._headers = address, jobs, headers
        self.served: dict[str, set[str]] = {}
        self.faults: list[str] = []
        self.answers: Counter[int] = Counter()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._look)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        self._stop.set()
        self._thread.join()

    def _look(self) -> None:
        """Fetch what was not seen yet, and some of the rest."""
        chance = random.Random(1)
        with httpx2.Client(base_url=self._address, headers=self._headers, timeout=PATIENCE_S) as client:
            while not self._stop.wait(0.2):
                known = list(self._jobs.items())
                unseen = [one for one in known if one[1] not in self.served]
                for job, text in unseen + chance.sample(known, min(_AT_ONCE, len(known))):
                    with suppress(*LOST):
                        self._look_at(client, job, text)

    def _get(self, client: httpx2.Client, path: str, **more: Mapping[str, str]) -> httpx2.Response:
        answer = client.get(path, **more)
        self.answers[answer.status_code] += 1
        return answer

    def _look_at(self, client: httpx2.Client, job: str, text: str) -> None:
        status = self._get(client, f"/v1/jobs/{job}/results", params=REFERENCES)
        if status.status_code != 200:
            if status.status_code not in (404, 503):
                self.faults.append(f"job {job}: {status.status_code} {status.text}")
            return
        answer = self._get(client, status.json()["database"]["href"], headers=FILE)
        if answer.status_code == 200:
            self.served.setdefault(text, set()).add(hashlib.sha256(answer.content).hexdigest())
            if not is_slow_content(answer.content, text):
                self.faults.append(f"{text}: {len(answer.content)} bytes, not its result")
        elif answer.status_code != 503:
            self.faults.append(f"{text}: {answer.status_code} {answer.text}")


EXECUTION = "/v1/processes/fake/execution"
_MARK = "LOA_TEST_MARK"
_BACKLOG = 3
WORKER = "service.worker."
"""What the command of a worker holds, started anew or forked."""
_ROOT = Path(__file__).resolve().parents[2]


@dataclass
class KilledService:
    """The service, its victims and its witness; `harms` is what else can be done to it, by name."""

    directory: Path
    settings: dict[str, str]
    harms: Mapping[str, Callable[[], object]] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    jobs: dict[str, str] = field(default_factory=dict)
    struck: list[str] = field(default_factory=list)
    span: float = 1.0
    mark: str = field(default_factory=lambda: uuid.uuid4().hex)
    _turns: threading.Lock = field(default_factory=threading.Lock)

    def __enter__(self) -> KilledService:
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=256)
        self._listener.set_inheritable(True)
        self.address = f"http://127.0.0.1:{self._listener.getsockname()[1]}"
        place = {_MARK: self.mark, "LOA_DATA_DIRECTORY": str(self.directory / "server")}
        environment = {**os.environ, **self.settings, **place}
        environment["PYTHONPATH"] = os.pathsep.join([str(_ROOT), os.environ["PYTHONPATH"]])
        self.server = Part(environment, self.directory / "server.log", self._listener.fileno())
        self.server.start()
        self._client = httpx2.Client(base_url=self.address, headers=self.headers, timeout=PATIENCE_S)
        self.witness = Witness(self.address, self.jobs, self.headers)
        self.witness.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.witness.stop()
        self._client.close()
        if self.server.process is not None and self.server.process.poll() is None:
            self.server.end(signal.SIGKILL)
        self._listener.close()

    @property
    def kinds(self) -> list[str]:
        """What can be done to it: each once."""
        return ["worker", "server", *self.harms]

    def request(self, method: str, path: str, **more: Any) -> httpx2.Response:
        """Ask until there is an answer, as the client does; what has ended is started again meanwhile."""
        end = time.monotonic() + PATIENCE_S
        while True:
            with suppress(*LOST):
                answer = self._client.request(method, path, **more)
                if answer.status_code != 503:
                    return answer
            assert time.monotonic() < end, f"no answer to {method} {path}"
            self.revive()
            time.sleep(0.05)

    def revive(self) -> None:
        with self._turns:
            self.server.revive()

    def submit(self, text: str) -> None:
        answer = self.request("POST", EXECUTION, json={"inputs": {"wish": {"mode": "slow", "text": text}}})
        assert answer.status_code == 201, answer.text
        self.jobs[answer.json()["jobID"]] = text

    def submit_batch(self, name: str, texts: Sequence[str]) -> str:
        """Enter a batch under a name, however often it has to be sent; return its identifier."""
        jobs = [{"wish": {"text": text}} for text in texts]
        body = {"process": "fake", "inputs": {"wish": {"mode": "slow"}}, "jobs": jobs}
        answer = self.request("POST", "/v1/batches", json=body, headers={"Idempotency-Key": name})
        assert answer.status_code == 201, answer.text
        return str(answer.json()["jobID"])

    def measure(self, text: str) -> None:
        """Run a job undisturbed: moments are chosen from somewhat more than its duration."""
        self.submit(text)
        began = time.monotonic()
        self.settled()
        self.span = time.monotonic() - began

    def strike(self, kind: str, chance: random.Random) -> None:
        """Wait for a worker with little else to do, for a random while, and do what `kind` says.

        Where nothing is left to do, an idle service is struck.
        """
        until(self._can_be_struck)
        time.sleep(chance.uniform(0.0, 1.2 * self.span))
        self.struck.append(kind)
        if kind in self.harms:
            self.harms[kind]()
        elif kind == "worker":
            for pid in self._workers()[:1]:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
        else:
            self.kill()

    def kill(self) -> None:
        """Kill the server and start it again; its workers end by themselves."""
        left = self._workers()
        with self._turns:
            self.server.end(signal.SIGKILL)
            self.server.start()
        until(lambda: not any(lives(pid) for pid in left))

    def _can_be_struck(self) -> bool:
        """Whether there is a worker and little else to do, or nothing."""
        unfinished = self._unfinished()
        return unfinished == 0 or (unfinished <= _BACKLOG and self._workers() != [])

    def _unfinished(self) -> int:
        self.revive()
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
        """Return the processes that do fake work: each stands in a directory below that of the service."""
        return processes_in(self.directory, WORKER)

    def settled(self) -> dict[str, Any]:
        """Wait until every job has ended; return their states."""
        ends: dict[str, Any] = {}
        for job in self.jobs:
            until(lambda job=job: self._ended(job, ends))
        return ends

    def _ended(self, job: str, ends: dict[str, Any]) -> bool:
        """Note the state of a job; whether it has ended."""
        ends[job] = self.request("GET", f"/v1/jobs/{job}").json()
        return ends[job]["status"] in ("successful", "failed", "dismissed")

    def stop(self) -> int:
        """Stop the server as a supervisor does; return its exit code."""
        self.witness.stop()
        until(self.server.heeds_stops)
        return self.server.end(signal.SIGTERM)
