"""A service in a process of its own, for benchmarks that ask it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from urllib.request import urlopen

_TICK = os.sysconf("SC_CLK_TCK")


@contextmanager
def running(
    directory: Path, log: Path | None = None, options: Sequence[str] = ()
) -> Iterator[tuple[str, subprocess.Popen[str], tuple[float, float]]]:
    """Run the service; its address, process, and seconds elapsed and CPU seconds until it answered.

    Its log goes to a file, if one is named; `options` are those of ``loa serve``.
    """
    begin = time.perf_counter()
    command = [sys.executable, "-m", "lineofaction.cli", "serve", "--port", "0", *options]
    with (log or Path(os.devnull)).open("w") as errors:
        process = subprocess.Popen(
            [*command, "--data-directory", str(directory)], stdout=subprocess.PIPE, stderr=errors, text=True
        )
    try:
        assert process.stdout is not None
        address = re.search(r"http://\S+", process.stdout.readline())
        assert address is not None
        _wait_for(f"{address.group()}/health")
        yield address.group(), process, (time.perf_counter() - begin, cpu_seconds(process.pid))
    finally:
        process.terminate()
        process.wait(timeout=30.0)


def _wait_for(url: str) -> None:
    """Ask until there is an answer."""
    end = time.perf_counter() + 120.0
    while True:
        try:
            with urlopen(url, timeout=60.0) as answer:
                answer.read()
                return
        except OSError:
            if time.perf_counter() > end:
                raise
            time.sleep(0.01)


def cpu_seconds(pid: int) -> float:
    """Return the CPU time of a process, s."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICK


def memory_mb(pid: int) -> float:
    """Return the resident memory of a process, MB."""
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    found = re.search(r"VmRSS:\s+(\d+)", status)
    assert found is not None
    return int(found.group(1)) / 1024.0


def idle_memory_mb(pid: int) -> float:
    """Return the memory of a process once it has nothing more to do, MB."""
    before, now = -1.0, cpu_seconds(pid)
    while now - before > 0.05:
        time.sleep(2.0)
        before, now = now, cpu_seconds(pid)
    return memory_mb(pid)
