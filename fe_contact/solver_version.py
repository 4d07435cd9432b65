"""Versions that a result is made with: the contact solver's, part of every content hash, and packages'."""

from __future__ import annotations

import platform
from functools import lru_cache
from importlib.metadata import version

SOLVER_VERSION = "25"
PACKAGES = ("lineofaction", "numpy", "scipy", "numba", "scikit-fem", "gmsh")


def software_versions() -> dict[str, str]:
    """Return the versions of solver and packages, by name."""
    return dict(_software_versions())


@lru_cache(maxsize=1)
def _software_versions() -> tuple[tuple[str, str], ...]:
    """Read the versions once: the files of the packages are long."""
    return ("python", platform.python_version()), *((name, version(name)) for name in PACKAGES)
