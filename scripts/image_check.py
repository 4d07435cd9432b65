"""Run the image as compose does and assess it: size, rights, answers, a clean stop, nothing lost."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Sequence
from pathlib import Path

from containers import READY_S, STOP_S, assess, await_answer, free_port, podman, same_table, the_case, tried
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.schemas import Case

_LARGEST_MB = 800.0


class Service:
    """One container of the image, with the rights that compose gives it, on a volume that outlives it."""

    def __init__(self, image: str, volume: str) -> None:
        self.port, self.name = free_port(), f"lineofaction-{uuid.uuid4().hex[:8]}"
        rights = ["--read-only", "--tmpfs", "/tmp", "--cap-drop", "all"]
        rights += ["--security-opt", "no-new-privileges"]
        place = ["--network", "host", "--env", f"LOA_PORT={self.port}", "--volume", f"{volume}:/data"]
        podman("run", "--detach", "--name", self.name, *rights, *place, image)
        self.start_s = await_answer(f"{self.url}/ready")

    @property
    def url(self) -> str:
        """Where it answers."""
        return f"http://127.0.0.1:{self.port}"

    def inside(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run a command in the container."""
        return tried("exec", self.name, *words)

    def cpu_s(self) -> float:
        """Return the CPU time of its processes so far, s: the start on a machine that does nothing else."""
        lines = self.inside("sh", "-c", "cat /proc/[0-9]*/stat").stdout.splitlines()
        ticks = [sum(map(int, line.rpartition(")")[2].split()[11:13])) for line in lines]
        return sum(ticks) / os.sysconf("SC_CLK_TCK")

    def stop(self) -> tuple[float, int]:
        """Send SIGTERM; return the seconds it took and the exit code."""
        begin = time.monotonic()
        podman("stop", "--time", "30", self.name)
        taken = time.monotonic() - begin
        return taken, int(podman("inspect", "--format", "{{.State.ExitCode}}", self.name))

    def remove(self) -> None:
        """Remove the container, running or not."""
        tried("rm", "--force", "--time", "0", self.name)


def rights(service: Service) -> list[bool]:
    """Assess what the process may do."""
    lines = service.inside("cat", "/proc/1/status").stdout.splitlines()
    status = dict(line.split(":\t", 1) for line in lines if ":\t" in line)
    user = status["Uid"].split()[0]
    healthy = tried("healthcheck", "run", service.name).returncode
    writing = service.inside("touch", "/opt/x").returncode
    return [
        assess("user of the service", user, good=user != "0"),
        assess("capabilities", status["CapEff"], good=int(status["CapEff"], 16) == 0),
        assess("new privileges refused", status["NoNewPrivs"], good=status["NoNewPrivs"] == "1"),
        assess("exit code of writing to the root file system", writing, good=writing != 0),
        assess("exit code of the image's health check", healthy, good=healthy == 0),
    ]


def ready(what: str, service: Service) -> bool:
    """Assess a start; others on the machine delay it, the CPU time says by how much."""
    figure = f"{service.start_s:.1f}, CPU time {service.cpu_s():.1f}"
    return assess(f"{what} (within {READY_S:g})", figure, good=service.start_s < READY_S)


def drawn(service: Service) -> bool:
    """Assess whether the container draws the pictures of its table."""
    draw = "loa report $(find /data -name '*.nc' | head -1) -o /data/page.html --images /data/pictures"
    done = service.inside("sh", "-c", f"{draw} && ls /data/pictures")
    count = done.stdout.count(".png") if done.returncode == 0 else 0
    return assess("pictures drawn of the table", count or done.stderr[-500:], good=count > 2)


def bill(service: Service) -> list[bool]:
    """Assess the image's bill of materials against the schema of its format and what is installed."""
    text = service.inside("cat", "/usr/share/sbom/lineofaction.cdx.json").stdout
    fault = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    names = [str(part["purl"]).partition("@")[0] for part in json.loads(text)["components"]]
    debian = service.inside(
        "sh", "-c", "dpkg-query -W -f '${db:Status-Abbrev}\n' | grep -c ^ii"
    ).stdout.strip()
    listed = sum(name.startswith("pkg:deb/") for name in names)
    python = {name.removeprefix("pkg:pypi/") for name in names if name.startswith("pkg:pypi/")}
    needed = {"gmsh", "numba", "scipy", "psycopg"}
    return [
        assess("fault of the bill of materials", fault, good=fault is None),
        assess(f"packages of Debian in it (dpkg has {debian})", listed, good=str(listed) == debian),
        assess("packages of Python in it", len(python), good=needed <= python),
    ]


def interrupted(service: Service, client: LineOfActionClient, case: Case) -> tuple[str, list[bool]]:
    """Stop the service while it computes the three-dimensional case; return the job and the verdicts."""
    solid = case.model_copy(update={"accuracy": case.accuracy.model_copy(update={"model": "3d"})})
    job = client.analyze.submit(solid).id
    while client.status(job).status == "accepted":
        time.sleep(0.05)
    state = client.status(job).status
    seconds, code = service.stop()
    return job, [
        assess("stopped in the middle of a job", state, good=state == "running"),
        assess(f"stop on SIGTERM, s (within {STOP_S:g})", f"{seconds:.1f}", good=seconds < STOP_S),
        assess("exit code of the stop", code, good=code in (0, 143)),
    ]


def resumed(client: LineOfActionClient, job: str, case: Case) -> list[bool]:
    """Assess what the next container makes of the jobs and results of the one before."""
    ended = client.wait(job, timeout=300.0)
    first = client.analyze.submit(case)
    client.fetch_file(client.result(first.id).key)  # verified by its digest
    return [
        assess("interrupted job after the restart", ended.kind, good=ended.kind == "database"),
        assess("table of before served from the volume", first.state.message, good=first.state.ended),
    ]


def verdicts_of(image: str, volume: str, scratch: Path) -> list[bool]:
    """Assess two containers, one after the other, on one volume."""
    case = the_case()
    first = Service(image, volume)
    try:
        verdicts = [ready("ready after, s", first), *rights(first), *bill(first)]
        with LineOfActionClient(first.url, cache_dir=scratch / "first") as client:
            verdicts += [same_table(client, case), drawn(first)]
            job, stopped = interrupted(first, client, case)
            verdicts += stopped
    finally:
        first.remove()
    second = Service(image, volume)
    try:
        verdicts.append(ready("ready after a restart, s", second))
        with LineOfActionClient(second.url, cache_dir=scratch / "second") as client:
            verdicts += resumed(client, job, case)
        idle = second.stop()[0]
        verdicts.append(assess(f"stop when idle, s (within {STOP_S:g})", f"{idle:.1f}", good=idle < STOP_S))
    finally:
        second.remove()
    return verdicts


def main(words: Sequence[str]) -> int:
    """Assess the image named on the command line."""
    (image,) = words
    size_mb = int(podman("image", "inspect", "--format", "{{.Size}}", image)) / 1e6
    small = assess(f"size, MB (at most {_LARGEST_MB:g})", f"{size_mb:.0f}", good=size_mb <= _LARGEST_MB)
    volume = f"lineofaction-{uuid.uuid4().hex[:8]}"
    try:
        with tempfile.TemporaryDirectory() as scratch:
            verdicts = [small, *verdicts_of(image, volume, Path(scratch))]
    finally:
        podman("volume", "rm", "--force", volume)
    return 0 if all(verdicts) else 1


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
