"""Imports of the verbs of the command line before they compute: CPU seconds of imports and in total."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.fresh_process import as_installed

SUBJECT = "start of a verb"
_EXAMPLES = Path(__file__).parents[1] / "examples"
_PAIR = _EXAMPLES / "palermo_spur_20_20.toml"
_SCENE = _EXAMPLES / "palermo_scene.toml"
_VERBS: tuple[tuple[str, ...], ...] = (
    ("--help",),
    ("plan", str(_PAIR)),
    ("analyze", str(_PAIR), "-o", "ste.nc"),
    ("ste", "ste.nc", "--torque", "100"),
    ("report", "ste.nc", "-o", "ste.html"),
    ("flank", str(_PAIR), "--torque", "100", "-o", "flank.nc"),
    ("simulate", str(_SCENE), "-o", "run.nc"),
    ("report", "run.nc", "-o", "run.html"),
    ("modes", str(_SCENE), "-o", "modes.nc"),
    ("response", str(_SCENE), "--speed-rpm", "100:2000:100", "-o", "response.nc"),
)
_PROGRAMS = {"the service's app": "import service.app", "the client": "import lineofaction.client"}


def figures() -> list[Figure]:
    """Run every verb twice; the second finds compiled code and condensed gears in the caches."""
    with tempfile.TemporaryDirectory() as folder:
        measured = []
        for verb in _VERBS:
            program = [sys.executable, "-X", "importtime", "-m", "lineofaction.cli", *verb]
            _cost(program, folder)
            title = verb[0] if verb[0] != "report" else f"report of {verb[1]}"
            measured += _figures(f"loa {title}", program, folder)
        for title, code in _PROGRAMS.items():
            measured += _figures(title, [sys.executable, "-X", "importtime", "-c", code], folder)
    return measured


def _figures(title: str, program: list[str], folder: str) -> list[Figure]:
    """Return CPU seconds of imports and of all, of one program."""
    imports, whole = _cost(program, folder)
    return [
        Figure(SUBJECT, f"{title}: imports", imports, "s"),
        Figure(SUBJECT, f"{title}: all", whole, "CPU s"),
    ]


def _cost(program: list[str], folder: str) -> tuple[float, float]:
    """Return seconds of imports and CPU seconds of a program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        program,
        cwd=folder,
        env=as_installed() | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return sum(map(own_microseconds, done.stderr.splitlines())) * 1e-6, spent


def own_microseconds(line: str) -> int:
    """Return the time of one module alone, from a line of Python's import record; 0 for other lines."""
    first = line.removeprefix("import time:").split("|")[0].strip()
    return int(first) if line.startswith("import time:") and first.isdigit() else 0
