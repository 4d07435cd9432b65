"""Write the dependencies of the lock files with the licenses of what is installed: out/site/licenses.md."""

from __future__ import annotations

import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "out" / "site" / "licenses.md"
_HEAD = """# Dependencies and their licenses

Every package of `requirements-dev.lock` with the license that its own metadata state, and what asks for it:
the service itself, an extra, or the tests alone. Written by `scripts/licenses.py`. lineofaction is licensed
GPL-3.0-or-later, because gmsh is GPL-2.0-or-later. The image also holds packages of its Debian base,
under their own licenses.

| package | version | license | requested by |
|---|---|---|---|
"""
_LINE = re.compile(r"(?P<name>[A-Za-z0-9._-]+)==(?P<version>[^ ;]+)")
_STATED_ELSEWHERE = {  # in files of the packages, not in metadata that are at hand
    "colorama": "BSD-3-Clause",  # on Windows alone
    "importlib-metadata": "Apache-2.0",  # this and the next two with Python 3.11 alone
    "lazy-importer": "Apache-2.0",
    "zipp": "MIT",
    "axe-playwright-python": "MIT (axe-core in it: MPL-2.0)",
    "fmpy": "BSD-2-Clause",
    "matplotlib": "PSF-based (matplotlib)",
}


def locked() -> dict[str, list[str]]:
    """Return the versions of every locked package; some have one for each version of Python."""
    found: dict[str, list[str]] = {}
    for line in (ROOT / "requirements-dev.lock").read_text("utf-8").splitlines():
        if match := _LINE.match(line):
            found.setdefault(match["name"], []).append(match["version"])
    return found


def license_of(name: str) -> str:
    """Return the license of an installed package."""
    if name in _STATED_ELSEWHERE:
        return _STATED_ELSEWHERE[name]
    facts = metadata.metadata(name)
    if facts.get("License-Expression"):
        return facts["License-Expression"]
    marks = [
        mark.split(" :: ")[-1] for mark in facts.get_all("Classifier") or [] if mark.startswith("License")
    ]
    text = (facts.get("License") or "").strip().split("\n")[0]
    short = text if 0 < len(text) < 60 and "opyright" not in text and "===" not in text else ""
    if marks and marks != ["Other/Proprietary License"]:
        return ", ".join(marks)
    return short or ", ".join(marks) or "not stated"


def askers() -> dict[str, str]:
    """Return for every package the first of: service, an extra, tests."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    groups = {"service": [*project["dependencies"], *extras["analysis"], *extras["service"]]}
    groups |= {
        f"extra `{name}`": requirements for name, requirements in extras.items() if name not in ("all", "dev")
    }
    groups["tests"] = extras["dev"]
    found: dict[str, str] = {}
    for group, requirements in groups.items():
        for requirement in requirements:
            if not requirement.startswith("lineofaction["):  # another group
                _follow(requirement, group, found)
    return found


def _follow(requirement: str, group: str, found: dict[str, str]) -> None:
    """Add a requirement and its requirements."""
    match = re.match(r"([A-Za-z0-9._-]+)(?:\[([^\]]*)\])?", requirement)
    assert match is not None
    name, extras = _plain(match[1]), (match[2] or "").split(",")
    if name in found and extras == [""]:
        return
    found.setdefault(name, group)
    try:
        further = metadata.requires(name) or []
    except metadata.PackageNotFoundError:
        return
    for line in further:
        extra = re.search(r"extra *== *['\"]([^'\"]+)['\"]", line)
        if extra is None or extra[1] in extras:
            _follow(line, group, found)


def _plain(name: str) -> str:
    """Return the normalized name of a package."""
    return re.sub(r"[-_.]+", "-", name).lower()


def rows() -> list[tuple[str, str, str, str]]:
    """Return name, versions, license and asker of each locked package; raises `PackageNotFoundError`."""
    by = askers()
    return [
        (name, ", ".join(versions), license_of(name), by.get(_plain(name), "tests"))
        for name, versions in sorted(locked().items())
    ]


def main() -> int:
    """Write the page."""
    try:
        lines = [f"| {' | '.join(row)} |" for row in rows()]
    except metadata.PackageNotFoundError as error:
        print(f"{error.name} is not installed", file=sys.stderr)
        return 1
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(_HEAD + "\n".join(lines) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
