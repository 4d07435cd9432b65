"""The point of a table at which it is exported."""

from __future__ import annotations

Point = dict[str, float | None]
"""Fields of a `FlankPoint` from options, None if the option is left out."""
