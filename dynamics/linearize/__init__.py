"""The system linearised about its static equilibrium: modes at rest and turning, forced response."""

from dynamics.linearize.common_period import CommonPeriod, common_period
from dynamics.linearize.harmonic_response import HarmonicResponse, harmonic_response
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.modes import Modes, natural_modes
from dynamics.linearize.whirl import WhirlModes, whirl_modes

__all__ = [
    "CommonPeriod",
    "HarmonicResponse",
    "LinearSystem",
    "Modes",
    "WhirlModes",
    "common_period",
    "harmonic_response",
    "linearize",
    "natural_modes",
    "whirl_modes",
]
