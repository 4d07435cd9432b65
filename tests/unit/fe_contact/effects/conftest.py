"""Bodies are condensed once for all of these tests."""

from __future__ import annotations

from condensed_once import condensed_bodies, condensed_once

__all__ = ["condensed_bodies", "condensed_once"]
