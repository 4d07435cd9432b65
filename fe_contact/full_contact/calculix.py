"""CalculiX as a child process: one deck, one thread, its limits, and how it ended."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from fe_contact.types import Status
from host import child_environment, ending_signal

PROGRAM = "ccx"
WALL_OVER_CPU = 20.0
"""Wall seconds that a CPU second may take on a busy machine before the run counts as hung."""
_LIMITED = 'ulimit -S -t "$1"; exec "$2" -i job'  # the limit ends it even where its parent is gone


@dataclass(frozen=True)
class Run:
    """The end of a CalculiX run.

    Attributes
    ----------
    status : Status
        CONVERGED; ITERATION_LIMIT where it gave up; NOT_COMPUTED past its limit or where it did not start.
    reason : str
        In words; empty if it converged.
    iterations : int
        Equilibrium iterations.
    printed : str
        Its .dat file.
    """

    status: Status
    reason: str
    iterations: int
    printed: str


def find_calculix() -> str | None:
    """Return the program, None if it is not installed."""
    return shutil.which(PROGRAM)


def version_of(program: str) -> str:
    """Return the name and version that the program states."""
    process = subprocess.run([program, "-v"], capture_output=True, text=True, timeout=60.0, check=False)
    stated = re.search(r"Version\s+(\S+)", process.stdout)
    return f"CalculiX {stated.group(1)}" if stated else "CalculiX"


def run_calculix(program: str, deck: str, folder: Path, cpu_limit: float) -> Run:
    """Run a deck in an empty folder.

    Parameters
    ----------
    program : str
        From `find_calculix`.
    deck : str
    folder : Path
        Everything is written here.
    cpu_limit : float
        CPU seconds after which it is ended; 20 times as much by the clock.
    """
    (folder / "job.inp").write_text(deck, encoding="ascii")
    command = ("sh", "-c", _LIMITED, "sh", f"{max(1, round(cpu_limit))}", program)
    threads = dict.fromkeys(("OMP_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER", "NUMBER_OF_CPUS"), "1")
    try:
        child = subprocess.run(
            command,
            cwd=folder,
            env=child_environment(**threads),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=WALL_OVER_CPU * cpu_limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Run(Status.NOT_COMPUTED, f"no result within {WALL_OVER_CPU * cpu_limit:.0f} s", 0, "")
    except OSError as error:
        return Run(Status.NOT_COMPUTED, f"cannot be started ({error})", 0, "")
    return _ended(child, folder, cpu_limit)


def _ended(child: subprocess.CompletedProcess[str], folder: Path, cpu_limit: float) -> Run:
    """Say how a child ended."""
    iterations = len(re.findall(r"^ iteration \d+", child.stdout, re.MULTILINE))
    if ending_signal(child.returncode) == "SIGXCPU":
        return Run(Status.NOT_COMPUTED, f"no result within {cpu_limit:.0f} CPU s", iterations, "")
    if child.returncode != 0 or "Job finished" not in child.stdout:
        return Run(Status.ITERATION_LIMIT, _complaint(child), iterations, "")
    return Run(Status.CONVERGED, "", iterations, (folder / "job.dat").read_text(encoding="ascii"))


def _complaint(child: subprocess.CompletedProcess[str]) -> str:
    """Return the first error it printed, on one line."""
    error = re.search(r"\*ERROR(.*?)(?:\n\s*\n|\Z)", child.stdout, re.DOTALL)
    message = " ".join(error.group(1).split()).removeprefix(":").strip() if error else "no error printed"
    return f"exit code {child.returncode}: {message}"
