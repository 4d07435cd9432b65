"""How far a computation is: what callers are told, and nobody."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Called as progress(stage, fraction)."""


def silent(_stage: str, _fraction: float) -> None:
    """Report no progress."""
