"""Resolve base and extras for every system and Python that the card names, by wheels alone.

Usage: resolver.py; needs the network and uv (`pip install uv`). Prints a row each and ends with 1 where one
differs from `WITHOUT_WHEELS`: a package that lost its wheels, or a limit that is none any more.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).resolve().parents[1]
PLATFORMS = {
    "Linux x86": "x86_64-manylinux_2_28",
    "Linux ARM": "aarch64-manylinux_2_28",
    "macOS Intel": "x86_64-apple-darwin",
    "macOS ARM": "aarch64-apple-darwin",
    "Windows": "x86_64-pc-windows-msvc",
}
"""Names of systems in the documentation, and as uv calls them."""
EXTRAS = ("", "analysis", "service")
VERSIONS = tuple(f"3.{minor}" for minor in range(11, 20))
"""Versions of Python of which those are resolved that pyproject.toml admits."""
WITHOUT_WHEELS = {
    ("Linux ARM", "analysis"): "gmsh",
    ("Linux ARM", "service"): "gmsh",
}
"""Package without wheels, by system and extra (docs/architecture.md, Host)."""
_CULPRIT = re.compile(r"(?:Because |and )([A-Za-z0-9_.-]+)[^,\n]*? has no (?:usable )?wheels")


def main() -> int:
    """Print all rows; return 0 if they are as stated, else 1."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    admitted = SpecifierSet(project["requires-python"])
    differing = 0
    for python in filter(admitted.contains, VERSIONS):
        for system, platform in PLATFORMS.items():
            for extra in EXTRAS:
                lacking = lacking_wheels(list(requirements(project, extra)), platform, python)
                is_stated = lacking == WITHOUT_WHEELS.get((system, extra), "")
                differing += not is_stated
                result = f"no wheels of {lacking}" if lacking else "resolved"
                print(
                    python,
                    system,
                    extra or "base",
                    result,
                    "" if is_stated else "<- NOT AS STATED",
                    flush=True,
                )
    return int(differing > 0)


def requirements(project: dict[str, object], extra: str) -> Iterator[str]:
    """Yield the requirements of the base with those of an extra and of the extras in it."""
    base, extras = project["dependencies"], project["optional-dependencies"]
    assert isinstance(base, list) and isinstance(extras, dict)
    yield from base
    for text in extras.get(extra, ()):
        requirement = Requirement(text)
        if requirement.name != project["name"]:
            yield text
        for inner in sorted(requirement.extras if requirement.name == project["name"] else ()):
            yield from extras[inner]


def lacking_wheels(wanted: list[str], platform: str, python: str) -> str:
    """Return the package without wheels for a system; empty: all resolve.

    Raises `RuntimeError`: they do not resolve for another reason.
    """
    command = ["uv", "pip", "compile", "-", "--quiet", "--only-binary", ":all:"]
    command += ["--python-platform", platform, "--python-version", python]
    done = subprocess.run(command, input="\n".join(wanted), capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return ""
    culprit = _CULPRIT.search(" ".join(done.stderr.split()))
    if culprit is None:
        raise RuntimeError(done.stderr)
    return re.split(r"[<>=!~]", culprit[1])[0]


if __name__ == "__main__":
    sys.exit(main())
