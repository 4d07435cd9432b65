"""Run the image as compose does and judge it: size, rights, answers, a clean stop, nothing lost."""

from __future__ import annotations

import socket
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Sequence
from pathlib import Path

import httpx2
import numpy as np

from fe_contact.analysis import analyze
from service.client import LineOfActionClient
from service.convert.case import analysis_arguments, case_json
from service.convert.checks import check_case
from service.schemas import Case, read_model

CASE = Path("examples/palermo_spur_20_20.toml")
LARGEST_MB, STOP_S, START_S = 800.0, 5.0, 30.0
SAME = 1e-9  # of a table computed here: another Python, the same libraries


def podman(*words: str) -> str:
    """Return what a command of podman prints."""
    return subprocess.run(["podman", *words], check=True, capture_output=True, text=True).stdout.strip()


def tried(*words: str) -> subprocess.CompletedProcess[str]:
    """Run a command of podman that may fail."""
    return subprocess.run(["podman", *words], check=False, capture_output=True, text=True)


def judge(what: str, figure: object, *, good: bool) -> bool:
    """Print one line of the verdict."""
    print(f"{'ok  ' if good else 'FAIL'}  {what}: {figure}", flush=True)
    return good


def free_port() -> int:
    """Return a port nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Service:
    """One container of the image, with the rights that compose gives it, on a volume that outlives it."""

    def __init__(self, image: str, volume: str) -> None:
        self.port, self.name = free_port(), f"lineofaction-{uuid.uuid4().hex[:8]}"
        rights = [
            "--read-only",
            "--tmpfs",
            "/tmp",
            "--cap-drop",
            "all",
            "--security-opt",
            "no-new-privileges",
        ]
        limits = [
            "--ulimit",
            "nofile=4096:4096",
            "--ulimit",
            "nproc=4096:4096",
        ]  # podman's own exceed some hosts'
        place = ["--network", "host", "--env", f"LOA_PORT={self.port}", "--volume", f"{volume}:/data"]
        begin = time.monotonic()
        podman("run", "--detach", "--runtime", "runc", "--name", self.name, *rights, *limits, *place, image)
        self.start_s = self._await_health(begin)

    def _await_health(self, begin: float) -> float:
        """Return the seconds until it answered."""
        while time.monotonic() - begin < START_S:
            try:
                if httpx2.get(f"{self.url}/health").status_code == 200:
                    return time.monotonic() - begin
            except httpx2.TransportError:
                time.sleep(0.05)
        raise SystemExit(f"The service did not answer within {START_S:g} s:\n{podman('logs', self.name)}")

    @property
    def url(self) -> str:
        """Where it answers."""
        return f"http://127.0.0.1:{self.port}"

    def inside(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run a command in the container."""
        return subprocess.run(
            ["podman", "exec", self.name, *words], check=False, capture_output=True, text=True
        )

    def stop(self) -> tuple[float, int]:
        """Send SIGTERM; return the seconds it took and the exit code."""
        begin = time.monotonic()
        podman("stop", "--time", "30", self.name)
        taken = time.monotonic() - begin
        return taken, int(podman("inspect", "--format", "{{.State.ExitCode}}", self.name))

    def remove(self) -> None:
        """Remove the container, running or not."""
        subprocess.run(
            ["podman", "rm", "--force", "--time", "0", self.name], check=False, capture_output=True
        )


def rights(service: Service) -> list[bool]:
    """Judge what the process may do."""
    status = dict(
        line.split(":\t", 1)
        for line in service.inside("cat", "/proc/1/status").stdout.splitlines()
        if ":\t" in line
    )
    user = status["Uid"].split()[0]
    healthy = tried("healthcheck", "run", service.name).returncode
    writing = service.inside("touch", "/opt/x").returncode
    return [
        judge("user of the service", user, good=user != "0"),
        judge("capabilities", status["CapEff"], good=int(status["CapEff"], 16) == 0),
        judge("new privileges refused", status["NoNewPrivs"], good=status["NoNewPrivs"] == "1"),
        judge("exit code of writing to the root file system", writing, good=writing != 0),
        judge("exit code of the image's health check", healthy, good=healthy == 0),
    ]


def answers(client: LineOfActionClient, case: Case) -> list[bool]:
    """Judge a table computed in the container against one computed here."""
    here = analyze(check_case(case), **analysis_arguments(case), case=case_json(case))
    there = client.analyze(case)
    ours, theirs = (np.asarray(t.to_xarray()["static_transmission_error"]) for t in (here, there))
    apart = float(np.max(np.abs(theirs - ours)) / np.max(np.abs(ours)))
    return [
        judge(
            f"table off the one computed here, relative (below {SAME:g})", f"{apart:.1e}", good=apart < SAME
        )
    ]


def interrupted(service: Service, client: LineOfActionClient, case: Case) -> tuple[str, list[bool]]:
    """Stop the service while it computes the three-dimensional case; return the job and the verdicts."""
    solid = case.model_copy(update={"accuracy": case.accuracy.model_copy(update={"model": "3d"})})
    job = client.submit_case(solid).id
    while client.status(job).status == "accepted":
        time.sleep(0.05)
    state = client.status(job).status
    seconds, code = service.stop()
    return job, [
        judge("stopped in the middle of a job", state, good=state == "running"),
        judge(f"stop on SIGTERM, s (within {STOP_S:g})", f"{seconds:.1f}", good=seconds < STOP_S),
        judge("exit code of the stop", code, good=code in (0, 143)),
    ]


def resumed(client: LineOfActionClient, job: str, case: Case) -> list[bool]:
    """Judge what the next container makes of the jobs and results of the one before."""
    ended = client.wait(job, timeout=300.0)
    first = client.submit_case(case)
    client.fetch_file(client.result(first.id).key)  # verified by its digest
    return [
        judge("interrupted job after the restart", ended.kind, good=ended.kind == "database"),
        judge("table of before served from the volume", first.message, good=first.status == "successful"),
    ]


def verdicts_of(image: str, volume: str, scratch: Path) -> list[bool]:
    """Judge two containers, one after the other, on one volume."""
    case = read_model(Case, CASE)
    first = Service(image, volume)
    try:
        verdicts = [judge("first answer after, s", f"{first.start_s:.1f}", good=True), *rights(first)]
        with LineOfActionClient(first.url, cache_dir=scratch / "first") as client:
            verdicts += answers(client, case)
            job, stopped = interrupted(first, client, case)
            verdicts += stopped
    finally:
        first.remove()
    second = Service(image, volume)
    try:
        verdicts.append(judge("answer after a restart, s", f"{second.start_s:.1f}", good=True))
        with LineOfActionClient(second.url, cache_dir=scratch / "second") as client:
            verdicts += resumed(client, job, case)
        verdicts.append(judge("stop when idle, s", f"{second.stop()[0]:.1f}", good=True))
    finally:
        second.remove()
    return verdicts


def main(words: Sequence[str]) -> int:
    """Judge the image named on the command line."""
    (image,) = words
    size_mb = int(podman("image", "inspect", "--format", "{{.Size}}", image)) / 1e6
    small = judge(f"size, MB (at most {LARGEST_MB:g})", f"{size_mb:.0f}", good=size_mb <= LARGEST_MB)
    volume = f"lineofaction-{uuid.uuid4().hex[:8]}"
    try:
        with tempfile.TemporaryDirectory() as scratch:
            verdicts = [small, *verdicts_of(image, volume, Path(scratch))]
    finally:
        podman("volume", "rm", "--force", volume)
    return 0 if all(verdicts) else 1


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
