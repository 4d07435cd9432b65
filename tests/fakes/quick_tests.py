"""Which tests `--quick` runs: those whose file imports nothing that meshes, marches in time, draws or serves.

A file is as quick as what it calls, and what it calls it imports: no list of tests to keep, and a new file is
sorted by itself.
"""

from types import ModuleType

import pytest

LONG = (
    "fe_contact.analysis", "fe_contact.compliance", "verification.full_contact", "fe_contact.mesh",
    "fe_contact.microgeometry", "model_studies.workers", "dynamics.accuracy", "dynamics.engines",
    "dynamics.integrators", "dynamics.periodic", "dynamics.simulation", "service.app",
    "lineofaction.cli", "lineofaction.client", "lineofaction.report.document", "lineofaction.report.drawing",
    "lineofaction.report.run", "lineofaction.report.ste",
    "service.live", "service.queue", "service.store", "service.worker", "benchmarks", "concurrent",
    "fastapi", "multiprocessing", "subprocess", "typer",
)  # fmt: skip
PROCESSES = {"postgres", "database_url", "s3_objects"}
"""Fixtures that start one."""


def is_quick(item: pytest.Item) -> bool:
    """Say whether neither the file of a test nor its fixtures need anything long."""
    assert isinstance(item, pytest.Function)
    return PROCESSES.isdisjoint(item.fixturenames) and not imports_long(item.module)


def imports_long(module: ModuleType) -> bool:
    origins = {f"{_origin(value)}." for value in list(vars(module).values())}
    return any(origin.startswith(f"{name}.") for origin in origins for name in LONG)


def _origin(value: object) -> str:
    return value.__name__ if isinstance(value, ModuleType) else str(getattr(value, "__module__", ""))
