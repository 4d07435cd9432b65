"""Full finite-element contact of a spur pair by CalculiX: a peer that shares the mesher and nothing else."""

from fe_contact.full_contact.calculix import Run, find_calculix, run_calculix, version_of
from fe_contact.full_contact.loaded_position import FullContactPoint, solve_position
from fe_contact.full_contact.meshing import FullContactMesh, full_contact_mesh
from fe_contact.full_contact.validity import refusal

__all__ = [
    "FullContactMesh",
    "FullContactPoint",
    "Run",
    "find_calculix",
    "full_contact_mesh",
    "refusal",
    "run_calculix",
    "solve_position",
    "version_of",
]
