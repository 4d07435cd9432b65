"""Full finite-element contact by condensation: a peer of the tables, which CalculiX checks in the tests.

It shares geometry and mesher with the rest of the project, and nothing of its contact.
"""

from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.solve import solve_full_contact
from verification.full_contact.helical.solve import HelicalMesh, solve_full_contact_helical
from verification.full_contact.over_face.solve import solve_full_contact_over_face
from verification.full_contact.table import FullContactPoint, FullContactTable
from verification.full_contact.validity import refusal, refusal_helical, refusal_over_face

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
