"""Stand-in processes for the tests of the service, importable here and in the workers."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
import structlog.testing
from condensed_once import condensed_bodies, condensed_once
from postgres_server import database_url, postgres
from s3_server import s3_objects, s3_url

__all__ = ["condensed_bodies", "condensed_once", "database_url", "postgres", "s3_objects", "s3_url"]

STAND_INS = str(Path(__file__).resolve().parents[2] / "stand_ins")


@pytest.fixture(autouse=True)
def _workers_find_stand_ins(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """Let workers import the stand-ins, and keep caches out of the home directory."""
    path = os.pathsep.join(part for part in (STAND_INS, os.environ.get("PYTHONPATH", "")) if part)
    monkeypatch.setenv("PYTHONPATH", path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    yield


@pytest.fixture(autouse=True)
def _quiet_log() -> Iterator[None]:
    """Keep the log out of the tests' output."""
    structlog.configure(processors=[structlog.testing.LogCapture()])
    yield
    structlog.reset_defaults()
