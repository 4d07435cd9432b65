"""The rungs of the ladder, in the order of what they usually cost; the last one valid is the reference."""

from __future__ import annotations

from fe_contact.analysis.ladder.closed_form import ISO6336, THIN_SLICES
from fe_contact.analysis.ladder.finite_elements import FiniteElementRung
from fe_contact.analysis.ladder.rung import Rung

RUNGS: tuple[Rung, ...] = (
    ISO6336,
    THIN_SLICES,
    FiniteElementRung("plane_strain", "2-D plane strain", "plane_strain", "standard"),
    FiniteElementRung("corrected_draft", "2-D corrected for the width, draft", "auto", "draft"),
    FiniteElementRung("corrected", "2-D corrected for the width, standard", "auto", "standard"),
    FiniteElementRung("corrected_fine", "2-D corrected for the width, fine", "auto", "fine"),
    FiniteElementRung("3d_draft", "3-D, draft", "3d", "draft"),
    FiniteElementRung("3d_standard", "3-D, standard", "3d", "standard"),
    FiniteElementRung("3d_fine", "3-D, fine, 23 slices", "3d", "fine", 23),
)
