"""Progress of a computation, reported to a caller or to nobody."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Called as progress(stage, fraction)."""


def silent(_stage: str, _fraction: float) -> None:
    """Report no progress."""
