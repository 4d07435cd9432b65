"""Run the tests of compiled loops with the oldest and the newest numba that pyproject.toml admits.

Usage: numba_ends.py [oldest] [newest]; without arguments both. Needs the network and uv (`pip install uv`).
An end has an environment of its own in out/numba, with the newest packages that its numba admits (llvmlite,
numpy and what the extra analysis takes). Ends with 1 where tests fail, or where packages do not resolve.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
PLACE = ROOT / "out" / "numba"
RUNNERS = ("pytest", "pytest-xdist", "hypothesis", "psutil")
"""Packages that run the tests and record them."""
TESTS = (
    "tests/unit/host/test_loops.py",  # internals of numba that are replaced
    "tests/unit/host/test_loop_cache.py",  # loops on disk, shipped ones too
    "tests/unit/host/test_equal_loops.py",  # a table and a run-up, by our loops and by numba as it is
    "tests/unit/dynamics/structure_code",  # code written for a scene, and llvmlite
    "tests/unit/dynamics/kernels",
)
PACKAGES = ("numba", "llvmlite", "numpy", "scipy")
"""Packages whose versions are printed."""
_VERSIONS = "import importlib.metadata as m; print(*(f'{name} {m.version(name)}' for name in %r))"


def main(names: list[str]) -> int:
    """Test the named ends, or both; return 0 if all pass, else 1."""
    ends = requirements(tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8")))
    failed = [name for name in names or ends if not passes(name, ends[name])]
    print(f"failed: {', '.join(failed)}" if failed else "passed")
    return int(bool(failed))


def requirements(project: dict[str, dict[str, object]]) -> dict[str, str]:
    """Return the requirement of the oldest and of the newest numba; raises `ValueError`: one is unbounded."""
    extras = project["project"]["optional-dependencies"]
    assert isinstance(extras, dict)
    (numba,) = (text for text in extras["analysis"] if Requirement(text).name == "numba")
    bounds = {specifier.operator: specifier.version for specifier in Requirement(numba).specifier}
    if bounds.keys() != {">=", "<"}:
        raise ValueError(f"{numba} must have a lowest version (>=) and an end (<)")
    return {"oldest": f"numba=={bounds['>=']}", "newest": numba}


def passes(name: str, requirement: str) -> bool:
    """Whether the tests pass in a new environment with this numba."""
    folder = PLACE / name
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    subprocess.run([sys.executable, "-m", "venv", "--clear", "--without-pip", str(folder)], check=True)
    install = ["uv", "pip", "install", "--quiet", "--python", str(python), "--editable"]
    resolved = subprocess.run([*install, ".[analysis]", requirement, *RUNNERS], cwd=ROOT, check=False)
    if resolved.returncode:
        return False
    print(f"{name}:", flush=True)
    subprocess.run([python, "-c", _VERSIONS % (PACKAGES,)], check=True)
    settings = {"PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(folder / "loops")}
    tests = [str(python), "-m", "pytest", "-q", "-n", "0", "--all", "-m", "", *TESTS]
    return subprocess.run(tests, cwd=ROOT, env={**os.environ, **settings}, check=False).returncode == 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
