"""A fidelity of the accuracy study: a way to the transmission error, be it a closed form or fine elements."""

from __future__ import annotations

from typing import Protocol

import model_studies
from fe_contact.analysis.request.request import Checked
from fe_contact.ste import SteDatabase


class Fidelity(model_studies.Fidelity[Checked], Protocol):
    """One way to a table of transmission error; those of one family differ by their mesh only.

    `element_size`: what a convergence is assessed by.
    """

    @property
    def element_size(self) -> float:
        """Size of the elements relative to the other fidelities of the family; 0 without elements."""

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request as this fidelity computes it: with its model and mesh.

        Raises `InputError`: the fidelity is not valid for it.
        """

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table without a cache, with its time, memory and error in the receipt."""
