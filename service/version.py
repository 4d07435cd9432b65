"""The version of the program, which is that of its solver."""

from __future__ import annotations

from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version


@lru_cache(maxsize=1)
def solver_version() -> str:
    """Return the version of the installed project; code that runs uninstalled says so."""
    try:
        return version("lineofaction")
    except PackageNotFoundError:
        return "uninstalled"
