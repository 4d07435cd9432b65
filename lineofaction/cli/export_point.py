"""The point of a table at which it is exported."""

from __future__ import annotations

Point = dict[str, float | None]
"""The fields of a `FlankPoint`, None where nothing is said."""
