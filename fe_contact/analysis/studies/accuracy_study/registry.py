"""The fidelities of the accuracy study, by their usual cost; the last valid one is the reference."""

from __future__ import annotations

from fe_contact.analysis.studies.accuracy_study.closed_form import ISO6336, THIN_SLICES
from fe_contact.analysis.studies.accuracy_study.fidelity import Fidelity
from fe_contact.analysis.studies.accuracy_study.finite_elements import FiniteElementFidelity

FIDELITIES: tuple[Fidelity, ...] = (
    ISO6336,
    THIN_SLICES,
    FiniteElementFidelity("plane_strain", "2-D plane strain", "plane_strain", "standard"),
    FiniteElementFidelity("corrected_draft", "2-D corrected for the width, draft", "auto", "draft"),
    FiniteElementFidelity("corrected", "2-D corrected for the width, standard", "auto", "standard"),
    FiniteElementFidelity("corrected_fine", "2-D corrected for the width, fine", "auto", "fine"),
    FiniteElementFidelity("3d_draft", "3-D, draft", "3d", "draft"),
    FiniteElementFidelity("3d_standard", "3-D, standard", "3d", "standard"),
    FiniteElementFidelity("3d_fine", "3-D, fine, 23 slices", "3d", "fine", 23),
)
