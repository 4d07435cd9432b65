"""What accuracy costs in time on a scene: models and settings from quasi-static to the finest steps."""

from __future__ import annotations

from dynamics.ladder.frontier import Frontier, RungResult, frontier
from dynamics.ladder.registry import RUNGS

__all__ = ["RUNGS", "Frontier", "RungResult", "frontier"]
