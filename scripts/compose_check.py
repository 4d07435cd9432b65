"""Run compose.yaml and assess it: keys, PostgreSQL, a Dask worker that is killed, a clean stop."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
import uuid
from pathlib import Path
from typing import Any

import httpx2
from containers import STOP_S, assess, await_answer, free_port, podman, same_table, the_case, tried

from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.problems import Unauthorised
from lineofaction.gearbox.schemas import Case

_PATIENCE_S = 300.0
_TEETH = range(21, 27)


class Composition:
    """The services of compose.yaml, on volumes of their own that end with it."""

    def __init__(self, scratch: Path) -> None:
        self.secrets = scratch / "secrets"
        self.name, self.port = f"lineofaction-{uuid.uuid4().hex[:8]}", free_port()
        subprocess.run(["scripts/secrets", str(self.secrets)], check=True)
        own = {"LOA_SECRETS": str(self.secrets), "LOA_PORT": str(self.port)}
        self._ours = ("--filter", f"label=com.docker.compose.project={self.name}")
        self._environment = {**os.environ, **own, "COMPOSE_PROJECT_NAME": self.name}

    @property
    def url(self) -> str:
        """Where it answers."""
        return f"http://127.0.0.1:{self.port}"

    def compose(self, *words: str, check: bool = True) -> str:
        """Run a command of compose and return what it prints."""
        done = subprocess.run(
            ["podman-compose", *words], env=self._environment, check=False, capture_output=True, text=True
        )
        if check and done.returncode != 0:
            raise SystemExit(f"podman-compose {' '.join(words)}:\n{done.stderr[-3000:]}")
        return done.stdout

    def start(self) -> float:
        """Start everything, the database first; return the seconds until HTTP answered."""
        begin = time.monotonic()
        self.compose("up", "--detach", "database")
        while "accepting" not in self.compose(
            "exec", "-T", "database", "pg_isready", "-h", "/tmp", check=False
        ):
            if time.monotonic() - begin > _PATIENCE_S:
                raise SystemExit("The database does not start:\n" + self.compose("logs", "database"))
            time.sleep(0.5)
        # step by step: podman 4 knows neither conditions of health nor dependencies of dependencies
        self.compose("run", "--rm", "--no-deps", "-T", "schema")
        self.compose("up", "--detach", "--no-deps", "--scale", "work=2", "scheduler", "work")
        self.compose("up", "--detach", "--no-deps", "service")
        await_answer(f"{self.url}/ready")
        return time.monotonic() - begin

    def containers(self, service: str) -> list[str]:
        """Return the names of a service's containers that run."""
        which = ("--filter", f"label=com.docker.compose.service={service}")
        return podman("ps", *self._ours, *which, "--format", "{{.Names}}").split()

    def remove(self) -> None:
        """Remove containers, networks and volumes."""
        for container in podman("ps", "--all", *self._ours, "--format", "{{.Names}}").split():
            tried("rm", "--force", "--time", "0", container)
        self.compose("down", "--volumes", check=False)

    def logs(self) -> str:
        """Return the end of all logs."""
        return self.compose("logs", "--tail", "20", check=False)


def stopped(run: Composition) -> list[bool]:
    """Assess how long the program's containers take to end on SIGTERM."""
    verdicts = []
    for container in run.containers("service"):
        begin = time.monotonic()
        podman("stop", "--time", "30", container)
        taken = time.monotonic() - begin
        what = f"stop on SIGTERM, s (within {STOP_S:g})"
        verdicts.append(assess(what, f"{taken:.1f}", good=taken < STOP_S))
    return verdicts


def guarded(run: Composition) -> list[bool]:
    """Assess what holds the containers in: limits, rights, secrets that only files hold, checks of health."""
    verdicts = []
    for container in (*run.containers("service"), *run.containers("work")):
        facts = json.loads(podman("inspect", container))[0]
        host, password = facts["HostConfig"], (run.secrets / "database_password").read_text()
        limits = [
            host["Memory"] > 0,
            0 < host["PidsLimit"] <= 512,
            host["NanoCpus"] > 0 or host["CpuQuota"] > 0,
        ]
        shown = password in json.dumps(facts)
        verdicts += [
            assess(f"limits of memory, processes, CPU of {container}", limits, good=all(limits)),
            assess("password shown by inspect", shown, good=not shown),
        ]
    healthy = tried("healthcheck", "run", run.containers("service")[0]).returncode
    return [*verdicts, assess("exit code of the check of health", healthy, good=healthy == 0)]


def live(run: Composition, client: LineOfActionClient, key: str) -> bool:
    """Assess whether the serving container answers live from what a worker condensed."""
    table = client.analyze(the_case()).metadata.content_hash
    begin, answer = time.monotonic(), None
    while answer is None or (answer.status_code == 503 and time.monotonic() - begin < _PATIENCE_S):
        answer = httpx2.post(  # the first one compiles, and goes on when it is repeated
            f"{run.url}/v1/databases/{table}/ste",
            json={"torque_n_m": [100.0], "pinion": {"profile_crowning_um": 5.0}},
            headers={"Authorization": f"Bearer {key}"},
            timeout=_PATIENCE_S,
        )
    found = answer.status_code if answer.status_code == 200 else answer.text[:300]
    return assess("status of a live answer", found, good=answer.status_code == 200)


def shared(run: Composition, client: LineOfActionClient, case: Case) -> list[bool]:
    """Kill one of two workers while both work; assess that every job ends."""
    jobs = [client.analyze.submit(_with_teeth(case, teeth)) for teeth in _TEETH]
    _until(lambda: sum(state.status == "running" for state in _states(client, jobs)) == 2, run)
    tried("kill", "--signal", "KILL", run.containers("work")[0])
    _until(lambda: all(state.ended for state in _states(client, jobs)), run)
    ends = [state.status for state in _states(client, jobs)]
    done = ends.count("successful")
    return [
        assess(f"of {len(ends)} jobs done, one worker killed", done, good=done == len(ends)),
    ]


def _with_teeth(case: Case, teeth: int) -> Case:
    """Return the pair of another number of teeth."""
    facts = case.model_dump(mode="json", exclude_unset=True)
    facts["pair"]["center_distance_mm"] = facts["pair"]["normal_module_mm"] * teeth
    for gear in ("pinion", "wheel"):
        facts["pair"][gear]["teeth"] = teeth
    return Case.model_validate(facts)


def _states(client: LineOfActionClient, jobs: list[Any]) -> list[JobState]:
    """Return the jobs as they are now."""
    return [client.status(job.id) for job in jobs]


def _until(condition: object, run: Composition) -> None:
    """Wait for a condition; fail with the logs if it does not come true."""
    begin = time.monotonic()
    while not condition():  # type: ignore[operator]
        if time.monotonic() - begin > _PATIENCE_S:
            raise SystemExit(f"Waited in vain.\n{run.logs()}")
        time.sleep(0.2)


def verdicts_of(run: Composition, scratch: Path) -> list[bool]:
    """Assess one life of the services, and a second on the same volumes."""
    once = ("run", "--rm", "--no-deps", "-T", "service")
    printed = run.compose(*once, "loa", "keys", "add", "check", "--json")
    key = json.loads(printed.splitlines()[-1])
    first = run.start()
    verdicts = [assess("all of it answers after, s", f"{first:.1f}", good=True)]
    with LineOfActionClient(run.url, cache_dir=scratch / "nobody", key="none") as nobody:
        try:
            nobody.analyze.submit(the_case())
            refused = False
        except Unauthorised:
            refused = True
    verdicts.append(assess("a caller without its key is refused", refused, good=refused))
    with LineOfActionClient(run.url, cache_dir=scratch / "first", key=key["key"]) as client:
        verdicts.append(same_table(client, the_case()))
        verdicts.append(live(run, client, key["key"]))
        verdicts += shared(run, client, the_case())
    verdicts += [*guarded(run), *stopped(run)]
    run.compose("stop")
    run.start()
    with LineOfActionClient(run.url, cache_dir=scratch / "second", key=key["key"]) as client:
        again = client.analyze.submit(the_case())
        client.fetch_file(client.result(again.id).key)
        found = again.state.status == "successful"
        verdicts.append(assess("table of before served after a restart", again.state.message, good=found))
    return verdicts


def main() -> int:
    """Assess compose.yaml as it stands."""
    with tempfile.TemporaryDirectory() as scratch:
        run = Composition(Path(scratch))
        try:
            verdicts = verdicts_of(run, Path(scratch))
        finally:
            run.remove()
    return 0 if all(verdicts) else 1


if __name__ == "__main__":
    raise SystemExit(main())
