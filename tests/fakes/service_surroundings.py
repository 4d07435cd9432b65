"""Fixtures around every test of the service, for the conftest of its folder."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
import structlog.testing
from fastapi.testclient import TestClient
from running_service import Bench, bench
from service_fakes import REGISTRY

from service.app import create_app
from service.settings import Settings

FAKES = str(Path(__file__).resolve().parent)


@pytest.fixture(autouse=True)
def workers_find_fakes(monkeypatch: pytest.MonkeyPatch) -> None:
    path = os.pathsep.join(part for part in (FAKES, os.environ.get("PYTHONPATH", "")) if part)
    monkeypatch.setenv("PYTHONPATH", path)


@pytest.fixture(autouse=True)
def unhurried_readiness(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a busy machine write late without being called not ready for it."""
    monkeypatch.setattr("service.store.write_check.PATIENCE_S", 60.0)


@pytest.fixture(autouse=True)
def quiet_log() -> Iterator[None]:
    """Keep the log out of the tests' output."""
    structlog.configure(processors=[structlog.testing.LogCapture()])
    yield
    structlog.reset_defaults()


@pytest.fixture
def machine(tmp_path: Path, database_url: str | None) -> Iterator[Bench]:
    """The machinery of jobs without a running scheduler, on each database."""
    made = bench(tmp_path, REGISTRY, database_url=database_url)
    yield made
    made.close()


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A caller of a running service of the fake process."""
    with TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY)) as caller:
        yield caller
