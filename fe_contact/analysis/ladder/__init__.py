"""The accuracy ladder: ways to the transmission error from a closed form to fine finite elements."""

from fe_contact.analysis.ladder.closed_form import ISO6336, THIN_SLICES, ClosedFormRung
from fe_contact.analysis.ladder.finite_elements import FiniteElementRung
from fe_contact.analysis.ladder.registry import RUNGS
from fe_contact.analysis.ladder.rung import Rung

__all__ = ["ISO6336", "RUNGS", "THIN_SLICES", "ClosedFormRung", "FiniteElementRung", "Rung"]
