"""The system linearised about its static equilibrium: natural modes."""

from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.modes import Modes, natural_modes

__all__ = ["LinearSystem", "Modes", "linearize", "natural_modes"]
