"""What a fidelity of the accuracy study is."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from fe_contact.analysis.request import Checked
from fe_contact.progress import Progress
from fe_contact.ste import SteDatabase


class Fidelity(Protocol):
    """One way to a table of transmission error, coarse or fine.

    Attributes
    ----------
    name : str
        Key in tables and JSON.
    title : str
        In words.
    family, element_size
        What a convergence is assessed by.
    """

    @property
    def name(self) -> str:
        """Key in tables and JSON."""

    @property
    def title(self) -> str:
        """In words."""

    @property
    def family(self) -> str:
        """Fidelities of one family differ by their mesh only."""

    @property
    def element_size(self) -> float:
        """Size of the elements beside that of the other fidelities of the family; 0 without elements."""

    def refusal(self, checked: Checked) -> str | None:
        """Say why this fidelity is not valid for a request; None if it is."""

    def as_asked(self, checked: Checked) -> Checked:
        """Return the request as this fidelity computes it: with its model and mesh.

        Raises
        ------
        InputError
            The fidelity is not valid for it.
        """

    def run(self, checked: Checked, progress: Progress, cache: Path | None) -> SteDatabase:
        """Compute the table, with its time, memory and error in the receipt."""
