"""The version of the program, which is that of its solver."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version


def solver_version() -> str:
    """Return the version of the installed project; code that runs uninstalled says so."""
    try:
        return version("lineofaction")
    except PackageNotFoundError:
        return "uninstalled"
