"""The cost of accuracy on a scene: models and settings from quasi-static to the finest steps."""

from __future__ import annotations

from dynamics.accuracy.frontier import FIDELITIES, FidelityResult, Frontier, frontier

__all__ = ["FIDELITIES", "FidelityResult", "Frontier", "frontier"]
