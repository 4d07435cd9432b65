"""Compliances of small gears, condensed each time."""

import pytest

from fe_contact.compliance import reduced_harmonics


@pytest.fixture(scope="module", autouse=True)
def condensed_once():
    """Condense each time: that is what these tests are about."""


@pytest.fixture
def exact_ring(monkeypatch):
    """Close rings to rounding; `test_closed_ring` holds what their limits leave."""
    for limit in ("MIN_PASSED", "MIN_ENERGY", "LARGEST_ERROR"):
        monkeypatch.setattr(reduced_harmonics, limit, 1e-13)
