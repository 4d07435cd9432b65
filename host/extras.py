"""Optional parts: extras of the installation, and functions that an operating system may lack."""

from __future__ import annotations

import sys
from functools import cache
from importlib.util import find_spec
from typing import Any

_REMEDY = "Use Linux, or macOS, or on Windows WSL or a container."
MODULES = {
    "abaqus": ("meshlane",),
    "dask": ("distributed",),
    "analysis": (
        "gmsh",
        "fast_simplification",
        "meshio",
        "numba",
        "pandas",
        "scipy",
        "skfem",
        "xarray",
    ),
    "service": (
        "alembic",
        "cbor2",
        "fastapi",
        "fastapi_swagger",
        "httptools",
        "opentelemetry",
        "prometheus_client",
        "pydantic_settings",
        "sqlalchemy",
        "structlog",
        "uvicorn",
    ),
}
"""Modules that come with each extra, as pyproject.toml has them by the names of their packages."""


class Unavailable(OSError):
    """The operating system does not offer what the program needs.

    `what`: what it does not offer, in the plural: "limits on memory".
    """

    def __init__(self, what: str, remedy: str = _REMEDY) -> None:
        super().__init__(f"{what} are not available on {sys.platform}. {remedy}")
        self.what, self.remedy = what, remedy

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the arguments of the constructor."""
        return type(self), (self.what, self.remedy)


class MissingExtra(ModuleNotFoundError):
    """A module of an extra that is not installed was needed."""

    def __init__(self, module: str, extra: str) -> None:
        remedy = f"pip install 'lineofaction[{extra}]'"
        super().__init__(f"{module} is not installed. It comes with the extra {extra}: {remedy}", name=module)
        self.extra = extra

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the arguments of the constructor."""
        return type(self), (self.name, self.extra)


@cache
def require(extra: str) -> None:
    """Raise `MissingExtra` unless all modules of an extra can be found; none is loaded.

    What computes calls it before it begins; what reads and draws results does not.
    """
    for module in MODULES[extra]:
        if find_spec(module) is None:
            raise MissingExtra(module, extra)


def missing_extra(error: ModuleNotFoundError) -> MissingExtra | None:
    """Return the missing extra that brings a module, None for another module."""
    module = (error.name or "").partition(".")[0]
    return next((MissingExtra(module, extra) for extra, names in MODULES.items() if module in names), None)
