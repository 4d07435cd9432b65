"""Full finite-element contact by condensation: a peer of the tables, which CalculiX checks in the tests.

It shares geometry and mesher with the rest of the project, and nothing of its contact.
"""

from fe_contact.full_contact.condensation.sites import Resolution
from fe_contact.full_contact.condensation.solve import solve_full_contact
from fe_contact.full_contact.helical.solve import HelicalMesh, solve_full_contact_helical
from fe_contact.full_contact.over_face.solve import solve_full_contact_over_face
from fe_contact.full_contact.table import FullContactPoint, FullContactTable
from fe_contact.full_contact.validity import refusal, refusal_helical, refusal_over_face

__all__ = [
    "FullContactPoint",
    "FullContactTable",
    "HelicalMesh",
    "Resolution",
    "refusal",
    "refusal_helical",
    "refusal_over_face",
    "solve_full_contact",
    "solve_full_contact_helical",
    "solve_full_contact_over_face",
]
