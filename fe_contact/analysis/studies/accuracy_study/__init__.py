"""The accuracy study: ways to the transmission error from a closed form to fine finite elements."""

from fe_contact.analysis.studies.accuracy_study.closed_form import ISO6336, THIN_SLICES, ClosedFormFidelity
from fe_contact.analysis.studies.accuracy_study.fidelity import Fidelity
from fe_contact.analysis.studies.accuracy_study.finite_elements import FiniteElementFidelity
from fe_contact.analysis.studies.accuracy_study.registry import FIDELITIES

__all__ = ["FIDELITIES", "ISO6336", "THIN_SLICES", "ClosedFormFidelity", "Fidelity", "FiniteElementFidelity"]
