"""The version of the program."""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version


@lru_cache(maxsize=1)
def solver_version() -> str:
    """Return the version of the installed project; code that runs uninstalled says so."""
    for distribution in ("lineofaction", "lineofaction-client"):
        with suppress(PackageNotFoundError):
            return version(distribution)
    return "uninstalled"
