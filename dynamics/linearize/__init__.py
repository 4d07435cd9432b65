"""The system linearized about its static equilibrium: modes at rest and over speed, forced response."""

from dynamics.linearize.campbell import whirl_modes
from dynamics.linearize.forced_response import ForcedResponse, forced_response, peaks
from dynamics.linearize.harmonic_response import HarmonicResponse, harmonic_response
from dynamics.linearize.linear_system import Modes, linearize, natural_modes
from dynamics.linearize.modal_analysis import ModalAnalysis, modal_analysis
from dynamics.linearize.operating_speeds import common_period
from dynamics.linearize.other_flanks import OtherFlanks
from dynamics.linearize.transfer import FlankTransfer, flank_transfer

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
