"""The stand-ins of the service are importable here too."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import structlog.testing

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stand_ins"))


@pytest.fixture(autouse=True)
def _quiet_log() -> Iterator[None]:
    """Keep the log out of the tests' output."""
    structlog.configure(processors=[structlog.testing.LogCapture()])
    yield
    structlog.reset_defaults()
