"""Write the bill of materials of an image (CycloneDX 1.6): the packages of Python and Debian in it.

Run in the image, so it needs nothing but Python: ``python sbom.py FILE``.
"""

from __future__ import annotations

import json
import platform
import subprocess
import sys
import uuid
from collections.abc import Iterator
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


def interpreter() -> Json:
    """Return the Python that runs: official images build their own, which dpkg does not know."""
    version = platform.python_version()
    return component("application", "cpython", version, f"pkg:generic/cpython@{version}")


def bill() -> Json:
    """Return the bill of materials; the same packages give the same text."""
    packages = {str(one["bom-ref"]): one for one in (*python_packages(), *debian_packages())}
    package = next((one for one in packages.values() if one["name"] == _NAME), None)
    parts = [interpreter(), *(one for _, one in sorted(packages.items()) if one is not package)]
    subject = {"component": {**package, "type": "container"}} if package is not None else {}
    serial = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps([subject, parts]))
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{serial}",
        "version": 1,
        "metadata": subject,
        "components": parts,
    }


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(bill(), indent=1) + "\n", encoding="utf-8")
