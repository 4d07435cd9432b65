"""The cost of accuracy on a scene: models and settings from quasi-static to the finest steps."""

from __future__ import annotations

from dynamics.accuracy.fidelities import FIDELITIES
from dynamics.accuracy.frontier import FidelityResult, Frontier, frontier

__all__ = ["FIDELITIES", "FidelityResult", "Frontier", "frontier"]
