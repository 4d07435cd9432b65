"""``loa doctor``: what machine and installation have and lack, and which verbs work with that."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec
from typing import NamedTuple

from packaging.requirements import Requirement

from host import missing_protections, physical_memory
from host.directories import cache_home
from host.extras import MODULES
from lineofaction.cli.output import console, print_json, table
from lineofaction.gearbox.program_version import solver_version
from lineofaction.report.drawing.printing import browser

BASE = ("new", "open", "ste", "report", "submit", "jobs", "fetch", "dismiss", "cache", "doctor")
"""Verbs of an installation without extras."""
OF_SERVICE = ("serve", "keys", "database", "store")
"""Verbs that need the extra service; all others but `BASE` need the extra analysis."""
HAS, LACKS, LIMITED = "has", "lacks", "limited"
_LIBRARIES = "Debian: apt-get install libglu1-mesa libgl1 libxcursor1 libxft2 libxinerama1 libgomp1"
"""Remedy for libraries of the system that gmsh needs (scripts/environment)."""
_UNDER_NGSOLVE = "Sound of exact lines needs it. Debian: apt-get install libquadmath0"
_LITTLE = 1 << 30
"""Free bytes of the disk of the caches below which a study may fill it."""
_SECONDS = 120.0
"""Limit of the import of a package in a process of its own."""


class Finding(NamedTuple):
    """A part of machine or installation: its name, its state, and details with the remedy."""

    name: str
    state: str
    text: str


def run_doctor(verbs: Iterable[str], *, as_json: bool) -> None:
    """Print all findings, and for the `verbs` of the program which of them work."""
    findings = [*_machine(), *_packages(), *_programs()]
    lacking = {finding.name.removeprefix("extra ") for finding in findings if finding.state == LACKS}
    able = {verb: not _needs(verb) & lacking for verb in verbs}
    if as_json:
        print_json({"findings": [finding._asdict() for finding in findings], "verbs": able})
        return
    out = console()
    out.print(table(["", "", ""], findings, text_columns=("",)))
    for words, works in (("these verbs work", True), ("these do not", False)):
        if names := [verb for verb, is_able in able.items() if is_able is works]:
            out.print(f"{words}: {', '.join(names)}", soft_wrap=True)


def _needs(verb: str) -> set[str]:
    """Return the parts that a verb needs, by the names of findings."""
    if verb in BASE:
        return {"base"}
    return {"base", "analysis", "gmsh"} | ({"service"} if verb in OF_SERVICE else set())


def _machine() -> Iterator[Finding]:
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    memory = f"{physical_memory() / 2**30:.1f} GiB"
    yield Finding(
        "machine", HAS, f"{platform.system()} {platform.machine()}, {processors} processors, {memory}"
    )
    yield Finding(
        "program", HAS, f"loa {solver_version()}, Python {platform.python_version()}, {sys.executable}"
    )
    folder = cache_home()
    present = next(parent for parent in (folder, *folder.parents) if parent.exists())
    free = shutil.disk_usage(present).free
    text = f"{folder}, {free / 2**30:.1f} GiB free"
    if not os.access(present, os.W_OK):
        yield Finding("cache", LIMITED, f"{text}; nothing can be written there: set LINEOFACTION_CACHE")
    else:
        yield Finding("cache", HAS if free > _LITTLE else LIMITED, text)
    if missing := missing_protections():
        yield Finding("confinement", LIMITED, f"files of others are read without {', '.join(missing)}")


def _packages() -> Iterator[Finding]:
    """Yield base and extras: packages that are missing, or of a version that is not supported."""
    for extra, requirements in _requirements().items():
        faults = [fault for fault in map(_fault, requirements) if fault]
        name = f"extra {extra}" if extra else "base"
        remedy = f"pip install 'lineofaction{f'[{extra}]' if extra else ''}'"
        text = (
            f"{'; '.join(faults)}: {remedy}"
            if faults
            else f"{len(requirements)} {'package' if len(requirements) == 1 else 'packages'}"
        )
        yield Finding(name, LACKS if faults else HAS, text)


def _requirements() -> Mapping[str, list[Requirement]]:
    """Return what base ("") and extras require on this system; of code that is not installed the extras."""
    try:
        stated = [Requirement(text) for text in requires("lineofaction") or ()]
    except PackageNotFoundError:
        return {
            extra: [Requirement(name.replace("_", "-")) for name in names] for extra, names in MODULES.items()
        }
    extras = ("", *MODULES)
    return {
        extra: [each for each in stated if each.name != "lineofaction" and _belongs(each, extra)]
        for extra in extras
    }


def _belongs(requirement: Requirement, extra: str) -> bool:
    if requirement.marker is None:
        return not extra
    in_base = requirement.marker.evaluate({"extra": ""})
    return in_base if not extra else not in_base and requirement.marker.evaluate({"extra": extra})


def _fault(requirement: Requirement) -> str:
    """Return what is wrong with a package; empty: nothing."""
    try:
        installed = version(requirement.name)
    except PackageNotFoundError:
        is_module = find_spec(requirement.name.replace("-", "_")) is not None  # its package has another name
        return "" if is_module else f"{requirement.name} is missing"
    if requirement.specifier.contains(installed, prereleases=True):
        return ""
    return f"{requirement.name} is {installed}, not {requirement.specifier}"


def _programs() -> Iterator[Finding]:
    """Yield what is no package of Python: libraries under gmsh and NGSolve, the browser that prints PDF."""
    for module, state, remedy in (("gmsh", LACKS, _LIBRARIES), ("ngsolve", LIMITED, _UNDER_NGSOLVE)):
        if find_spec(module) is None:
            continue
        command = [sys.executable, "-P", "-c", f"import {module}"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)
        if done.returncode:
            last = done.stderr.strip().rpartition("\n")[2]
            yield Finding(module, state, f"it does not load ({last}). {remedy}")
        else:
            yield Finding(module, HAS, "it loads")
    path = browser()
    remedy = "reports as PDF need Chromium or Chrome; the variable CHROMIUM may name it"
    yield Finding("browser", HAS if path else LIMITED, path or remedy)
