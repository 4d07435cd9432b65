"""Compile the loops of first tables and of a run-up into the installed package, for families of processors.

Usage: build_loops.py [FAMILY ...]   x86-64-v3, x86-64-v4; without: that of this processor
A family that this processor lacks is left out: loops are run, not only compiled. Entries go to
`host.loop_cache.SHIPPED`, which every process reads; results are thrown away.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import llvmlite.binding

from host.loop_cache import SHIPPED
from host.processor_family import FAMILIES, family_of

ENTRIES = {".nbi", ".nbc"}
"""Endings of index and machine code of a loop: what the package holds."""
EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
STEPS = (
    (
        ("analyze", EXAMPLES / "palermo_spur_20_20.toml", "-o", "spur.nc"),
        ("analyze", EXAMPLES / "helical_ev_23_67.toml", "-o", "helical.nc"),
    ),
    (("simulate", EXAMPLES / "palermo_scene.toml", "-o", "run.nc"),),  # finds its table in the cache
)
"""Commands of `loa` for a first table and a first run; the commands of a step run side by side."""


def main(families: list[str]) -> None:
    """Compile for each family, anew."""
    own = family_of(llvmlite.binding.get_host_cpu_features(), platform.machine())
    names = list(FAMILIES)
    possible = names[names.index(own) :] if own else []
    shutil.rmtree(SHIPPED, ignore_errors=True)
    for family in families or [own]:
        if family in possible:
            compute({"NUMBA_CPU_NAME": family, "NUMBA_CPU_FEATURES": ""})
        else:
            print(f"no loops for {family}: this processor is none", file=sys.stderr)
    for file in SHIPPED.rglob("*"):
        if file.is_file() and file.suffix not in ENTRIES:  # locks, sources, structures that were run
            file.unlink()


def compute(settings: dict[str, str]) -> None:
    """Run the first verbs; each loop is compiled by one of them, and kept among those of the package."""
    with TemporaryDirectory() as folder:
        environment = {
            **os.environ,
            **settings,
            "NUMBA_CACHE_DIR": str(SHIPPED),
            "LINEOFACTION_CACHE": str(Path(folder, "cache")),
            "OMP_NUM_THREADS": "1",
        }
        command = [sys.executable, "-m", "lineofaction.cli"]
        for step in STEPS:
            verbs = [
                subprocess.Popen([*command, *verb], cwd=folder, env=environment, stdout=subprocess.DEVNULL)
                for verb in step
            ]
            codes = [verb.wait() for verb in verbs]
            if any(codes):
                raise SystemExit("a verb failed; loops that were compiled before stay")


if __name__ == "__main__":
    main(sys.argv[1:])
