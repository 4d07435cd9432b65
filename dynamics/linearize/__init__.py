"""The system linearised about its static equilibrium: natural modes, at rest and turning."""

from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.modes import Modes, natural_modes
from dynamics.linearize.whirl import WhirlModes, whirl_modes

__all__ = ["LinearSystem", "Modes", "WhirlModes", "linearize", "natural_modes", "whirl_modes"]
