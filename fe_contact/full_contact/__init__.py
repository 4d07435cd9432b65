"""Full finite-element contact of spur pairs: a condensed peer, and CalculiX that checks it.

They share geometry and mesher with the rest of the project, and nothing of its contact.
"""

from fe_contact.full_contact.condensation import FullContactTable, Resolution, solve_full_contact
from fe_contact.full_contact.loaded_position import (
    Run,
    find_calculix,
    run_calculix,
    solve_position,
    version_of,
)
from fe_contact.full_contact.over_face import solve_full_contact_over_face
from fe_contact.full_contact.table import FullContactPoint
from fe_contact.full_contact.validity import refusal, refusal_over_face

__all__ = [
    "FullContactPoint",
    "FullContactTable",
    "Resolution",
    "Run",
    "find_calculix",
    "refusal",
    "refusal_over_face",
    "run_calculix",
    "solve_full_contact",
    "solve_full_contact_over_face",
    "solve_position",
    "version_of",
]
