"""Build the client as a light distribution, ``lineofaction-client``: the modules that its import loads.

Usage: client_wheel.py FOLDER
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
NEEDS = ("numpy", "pydantic", "annotated-types", "httpx2")
_LOADED = """
import importlib, json, pkgutil, sys
import lineofaction.client, lineofaction.gearbox.subjects
from lineofaction.gearbox import schemas
from lineofaction.gearbox.registry import STUDIES
[getattr(schemas, name) for name in schemas.HOMES]  # loaded on first use
[study.answer for study in STUDIES.values()]
for module in pkgutil.walk_packages(lineofaction.client.__path__, "lineofaction.client."):
    importlib.import_module(module.name)
files = (getattr(module, "__file__", None) for module in list(sys.modules.values()))
print(json.dumps([file for file in files if file]))
"""


def client_files() -> list[Path]:
    """Return the files of the project that the client loads, and their types, relative to the project."""
    command = [sys.executable, "-c", _LOADED]
    printed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    loaded = (Path(name) for name in json.loads(printed))
    files = {file.relative_to(ROOT) for file in loaded if file.is_relative_to(ROOT)}
    files = {file for file in files if not file.parts[0].startswith(".")}
    for file in list(files):
        typed = file.with_name("py.typed")
        files |= {typed} if (ROOT / typed).exists() else set()
    return sorted(files)


def project() -> dict[str, Any]:
    """Return the metadata of the whole project."""
    found: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    return found


def collect(folder: Path) -> None:
    """Write the sources of the distribution into a folder."""
    for file in client_files():
        target = folder / file
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / file, target)
    shutil.copyfile(ROOT / "LICENSE", folder / "LICENSE")
    whole = project()
    needs = [need for need in whole["dependencies"] if need.partition(">=")[0] in NEEDS]
    assert len(needs) == len(NEEDS)
    packages = sorted({".".join(file.parent.parts) for file in client_files()})
    (folder / "pyproject.toml").write_text(
        f"""[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "lineofaction-client"
version = "{whole["version"]}"
description = "Client of the lineofaction service: analysis of gear pairs and their dynamics over HTTP"
requires-python = "{whole["requires-python"]}"
license = "{whole["license"]}"
license-files = ["LICENSE"]
dependencies = {json.dumps(needs)}

[tool.setuptools]
packages = {json.dumps(packages)}

[tool.setuptools.package-data]
"*" = ["py.typed"]
""",
        encoding="utf-8",
    )


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        collect(Path(place))
        command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", sys.argv[1], place]
        subprocess.run(command, check=True)
