"""The system linearized about its static equilibrium: modes at rest and over speed, forced response."""

from dynamics.linearize.campbell import WhirlModes, whirl_modes
from dynamics.linearize.forced_response import (
    ForcedResponse,
    Peak,
    PowerBalance,
    forced_response,
    peaks,
    power_balance,
)
from dynamics.linearize.harmonic_response import HarmonicResponse, harmonic_response
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.modal_analysis import ModalAnalysis, modal_analysis
from dynamics.linearize.modes import Modes, natural_modes
from dynamics.linearize.operating_speeds import CommonPeriod, common_period

__all__ = [
    "CommonPeriod",
    "ForcedResponse",
    "HarmonicResponse",
    "LinearSystem",
    "ModalAnalysis",
    "Modes",
    "Peak",
    "PowerBalance",
    "WhirlModes",
    "common_period",
    "forced_response",
    "harmonic_response",
    "linearize",
    "modal_analysis",
    "natural_modes",
    "peaks",
    "power_balance",
    "whirl_modes",
]
