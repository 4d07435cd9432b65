"""Full contact by condensation: one mesh and one factorisation of each gear for all torques of a position."""

from fe_contact.full_contact.condensation.sites import Resolution
from fe_contact.full_contact.condensation.solve import solve_full_contact
from fe_contact.full_contact.table import FullContactTable

__all__ = ["FullContactTable", "Resolution", "solve_full_contact"]
