"""Loaded contact of gear teeth: points of contact, forces on them, and lag of the driven gear."""

from fe_contact.contact.adjoint import adjoint, force_changes, load_arm
from fe_contact.contact.assembly import contact_problem
from fe_contact.contact.candidates import PatchRule, contact_candidates, teeth_in_reach, with_gaps
from fe_contact.contact.carrying_strips import CarryingStrips
from fe_contact.contact.contact_pressure import contact_pressure
from fe_contact.contact.face_assembly import face_contact_problem, with_face_tilt
from fe_contact.contact.flank_forces import face_flank_forces, plane_flank_forces
from fe_contact.contact.model import Break, ContactModel
from fe_contact.contact.model_terms import with_compliances, with_flanks
from fe_contact.contact.pitches import in_pitches
from fe_contact.contact.problem import Candidates, ContactProblem, LoadedSlices
from fe_contact.contact.slices import Slices
from fe_contact.contact.solution_start import Start
from fe_contact.contact.sweep import ContactSolution, solve_contact

__all__ = [
    "Break",
    "Candidates",
    "CarryingStrips",
    "ContactModel",
    "ContactProblem",
    "ContactSolution",
    "LoadedSlices",
    "PatchRule",
    "Slices",
    "Start",
    "adjoint",
    "contact_candidates",
    "contact_pressure",
    "contact_problem",
    "face_contact_problem",
    "face_flank_forces",
    "force_changes",
    "in_pitches",
    "load_arm",
    "plane_flank_forces",
    "solve_contact",
    "teeth_in_reach",
    "with_compliances",
    "with_face_tilt",
    "with_flanks",
    "with_gaps",
]
