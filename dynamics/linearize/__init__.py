"""The system linearized about its static equilibrium: modes at rest and over speed, forced response."""

from dynamics.linearize.common_period import common_period
from dynamics.linearize.forced_response import ForcedResponse, forced_response, peaks
from dynamics.linearize.harmonic_response import HarmonicResponse, harmonic_response
from dynamics.linearize.linear_system import linearize
from dynamics.linearize.modal_analysis import ModalAnalysis, modal_analysis
from dynamics.linearize.natural_modes import Modes, natural_modes
from dynamics.linearize.other_flanks import OtherFlanks
from dynamics.linearize.transfer import FlankTransfer, flank_transfer
from dynamics.linearize.whirl_modes import whirl_modes

__all__ = [
    "FlankTransfer",
    "ForcedResponse",
    "HarmonicResponse",
    "ModalAnalysis",
    "Modes",
    "OtherFlanks",
    "common_period",
    "flank_transfer",
    "forced_response",
    "harmonic_response",
    "linearize",
    "modal_analysis",
    "natural_modes",
    "peaks",
    "whirl_modes",
]
