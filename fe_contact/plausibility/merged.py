"""Findings of a request beside those of its results."""

from __future__ import annotations

from collections.abc import Sequence

from bounds import Finding

SOLVED = ("hertz_pressure", "transmission_error")
"""Checks that a table answers by its own figures."""


def merged(requested: Sequence[Finding], solved: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return the findings of a request and of its results: what is solved replaces what was estimated."""
    return (*(finding for finding in requested if finding.check not in SOLVED), *solved)


def unexpected(requested: Sequence[Finding], solved: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return the findings of results that those of the request did not announce."""
    expected = {finding.check for finding in requested}
    return tuple(finding for finding in solved if finding.check not in expected)
