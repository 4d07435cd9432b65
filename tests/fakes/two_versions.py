"""Servers and schedulers of two versions of the program on one database, exchanged one after the other."""

from __future__ import annotations

import hashlib
import os
import random
import signal
import socket
import subprocess
import sys
import uuid
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
import rfc8785
from killed_service import Part
from running_service import PATIENCE_S, REFERENCES, until

_VERB = """
from importlib import import_module
from importlib.util import find_spec
old = find_spec("service.cli")  # where the command line was until 0.2
import_module("service.cli" if old else "lineofaction.cli").main()
"""

_FAKES = Path(__file__).resolve().parent
_TRIES = (httpx2.TransportError, ConnectionError)


@dataclass(frozen=True)
class Version:
    """A version of the program: its packages in `tree`, and in `names` the metadata of its number."""

    number: str
    tree: Path
    names: Path

    @classmethod
    def of(cls, number: str, tree: Path, scratch: Path) -> Version:
        names = scratch / f"named_{number}"
        facts = names / f"lineofaction-{number}.dist-info"
        facts.mkdir(parents=True, exist_ok=True)
        text = f"Metadata-Version: 2.1\nName: lineofaction\nVersion: {number}\n"
        (facts / "METADATA").write_text(text)
        return cls(number, tree, names)

    @property
    def path(self) -> str:
        return os.pathsep.join(map(str, (self.names, self.tree, _FAKES)))

    def key(self, inputs: Mapping[str, Any]) -> str:
        """Return the name that this version gives the result of the fake process; stated here once more."""
        facts = {"process": "fake", "process_version": "1", "solver_version": self.number, "inputs": inputs}
        return hashlib.sha256(rfc8785.dumps(facts)).hexdigest()


@dataclass
class Server:
    """A server and the socket on which it, or who comes after it, answers."""

    part: Part
    listener: socket.socket

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.listener.getsockname()[1]}"

    def request(self, method: str, path: str, **more: Any) -> httpx2.Response:
        """Ask until there is an answer; what was killed is started again meanwhile."""
        answers: list[httpx2.Response] = []

        def answered() -> bool:
            self.part.revive()
            with suppress(*_TRIES):
                answer = httpx2.request(method, self.address + path, timeout=PATIENCE_S, **more)
                if answer.status_code != 503:
                    answers.append(answer)
            return answers != []

        until(answered)
        return answers[0]


@dataclass
class RollingService:
    """What runs of both versions, and the jobs that were entered: the text of the wish by job."""

    directory: Path
    settings: dict[str, str]
    servers: list[Server] = field(default_factory=list)
    workers: list[Part] = field(default_factory=list)
    jobs: dict[str, str] = field(default_factory=dict)

    def upgrade(self, version: Version) -> None:
        """Bring the database up to the schema of a version, as its `loa database upgrade` does."""
        words = [sys.executable, "-c", _VERB, "database", "upgrade"]
        environment = self._environment(version, "upgrade")
        subprocess.run(words, env=environment, check=True, capture_output=True, timeout=PATIENCE_S)

    def serve(self, version: Version) -> Server:
        listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        listener.set_inheritable(True)
        server = Server(self._part("serve", version, listener.fileno()), listener)
        self.servers.append(server)
        server.request("GET", "/health")
        return server

    def work(self, version: Version) -> Part:
        self.workers.append(self._part("work", version))
        return self.workers[-1]

    def end(self, part: Part, number: signal.Signals) -> None:
        self.workers = [worker for worker in self.workers if worker is not part]
        gone = [server for server in self.servers if server.part is part]
        self.servers = [server for server in self.servers if server.part is not part]
        if number == signal.SIGTERM:
            until(part.heeds_stops)
        part.end(number)
        for server in gone:
            server.listener.close()

    def kill_one(self, chance: random.Random) -> None:
        """Kill a part; a supervisor starts it again."""
        part = chance.choice([*self.workers, *(server.part for server in self.servers)])
        part.end(signal.SIGKILL)
        part.start()

    def submit(self, text: str, chance: random.Random) -> None:
        """Enter a job at one of the servers, under a name: a repeated request enters it once."""
        body = {"inputs": {"wish": {"mode": "sign", "text": text}}}
        headers = {"Idempotency-Key": uuid.uuid4().hex}
        server = chance.choice(self.servers)
        answer = server.request("POST", "/v1/processes/fake/execution", json=body, headers=headers)
        assert answer.status_code in (200, 201), answer.text
        self.jobs[answer.json()["jobID"]] = text

    def ended(self) -> dict[str, str]:
        """Wait until every job has ended, as the last server tells it; return the states."""
        states: dict[str, str] = {}

        def all_ended() -> bool:
            for worker in self.workers:
                worker.revive()
            for job in self.jobs.keys() - states.keys():
                state = self.servers[-1].request("GET", f"/v1/jobs/{job}").json()
                if state["status"] not in ("accepted", "running"):
                    states[job] = f"{state['status']}: {state['message']}"
            return len(states) == len(self.jobs)

        until(all_ended)
        return states

    def result(self, job: str) -> tuple[str, str]:
        server = self.servers[-1]
        references = server.request("GET", f"/v1/jobs/{job}/results", params=REFERENCES)
        assert references.status_code == 200, references.text
        reference = references.json()["database"]
        file = {"Accept": "application/x-netcdf"}
        answer = server.request("GET", reference["href"].removeprefix(server.address), headers=file)
        assert answer.status_code == 200, answer.text
        return reference["hash"], answer.text

    def close(self) -> None:
        for part in [*self.workers, *(server.part for server in self.servers)]:
            self.end(part, signal.SIGKILL)

    def _part(self, role: str, version: Version, descriptor: int | None = None) -> Part:
        name = f"{role}_{version.number}_{uuid.uuid4().hex[:6]}"
        part = Part(role, self._environment(version, name), self.directory / f"{name}.log", descriptor)
        part.start()
        return part

    def _environment(self, version: Version, name: str) -> dict[str, str]:
        """Return the environment of a process: its version decides where its modules come from."""
        place = {"LOA_DATA_DIRECTORY": str(self.directory / name), "PYTHONPATH": version.path}
        return {**os.environ, **self.settings, **place}
