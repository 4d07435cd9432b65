"""Compliances of small gears, condensed each time."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="module", autouse=True)
def condensed_once() -> None:
    """Condense each time: that is what these tests are about."""
