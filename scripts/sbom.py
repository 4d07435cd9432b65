"""Write a bill of materials (CycloneDX 1.6) of an image, or of what a wheel is tested with.

Usage: sbom.py FILE [LOCK]   needs nothing but Python
In an image: the packages of Python and Debian in it. With a lock: the installed packages that it names, since
tools and system of the machine that makes a release are no part of it.
"""

from __future__ import annotations

import json
import platform
import re
import subprocess
import sys
import uuid
from collections.abc import Iterable, Iterator
from importlib import metadata
from pathlib import Path
from urllib.parse import quote

Json = dict[str, object]

_NAME = "lineofaction"
_FORMAT = "${db:Status-Abbrev}\t${Package}\t${Version}\t${Architecture}\n"


def component(kind: str, name: str, version: str, purl: str) -> Json:
    """Return one component."""
    return {"type": kind, "bom-ref": purl, "name": name, "version": version, "purl": purl}


def python_packages() -> Iterator[Json]:
    """Yield the installed distributions, with the licenses that their metadata state."""
    for found in metadata.distributions():
        name, version = found.name, found.version
        one = component(
            "library", name, version, f"pkg:pypi/{name.lower().replace('_', '-')}@{quote(version)}"
        )
        expression = found.metadata.get("License-Expression")
        yield one | ({"licenses": [{"expression": expression}]} if expression else {})


def debian_packages() -> Iterator[Json]:
    """Yield the packages that dpkg says are installed; none where there is no dpkg."""
    try:
        listed = subprocess.run(
            ["dpkg-query", "-W", "-f", _FORMAT], check=True, capture_output=True, text=True
        )
    except FileNotFoundError:
        return
    for line in listed.stdout.splitlines():
        state, name, version, architecture = line.split("\t")
        if state.startswith("ii"):
            purl = f"pkg:deb/debian/{quote(name)}@{quote(version)}?arch={architecture}"
            yield component("library", name, version, purl)


def locked(lock: Path) -> Iterator[Json]:
    """Yield the installed distributions that a lock names, and ours."""
    names = set(re.findall(r"^([\w.-]+)==", lock.read_text("utf-8"), re.M))
    for one in python_packages():
        if _canonical(str(one["name"])) in {_NAME, *map(_canonical, names)}:
            yield one


def _canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def interpreter() -> Json:
    """Return the Python that runs: official images build their own, which dpkg does not know."""
    version = platform.python_version()
    return component("application", "cpython", version, f"pkg:generic/cpython@{version}")


def bill(packages: Iterable[Json], kind: str, base: Iterable[Json] = ()) -> Json:
    """Return the bill of a subject of that kind; the same packages give the same text."""
    listed = {str(one["bom-ref"]): one for one in packages}
    package = next((one for one in listed.values() if one["name"] == _NAME), None)
    parts = [*base, *(one for _, one in sorted(listed.items()) if one is not package)]
    subject = {"component": {**package, "type": kind}} if package is not None else {}
    serial = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps([subject, parts]))
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{serial}",
        "version": 1,
        "metadata": subject,
        "components": parts,
    }


def bill_of_image() -> Json:
    """Return the bill of all that is installed."""
    return bill((*python_packages(), *debian_packages()), "container", [interpreter()])


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.parent.mkdir(parents=True, exist_ok=True)
    made = bill(locked(Path(sys.argv[2])), "library") if len(sys.argv) > 2 else bill_of_image()
    file.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
