"""Optional physics of the contact analysis: only what the scene calls for."""

from fe_contact.effects.composer import LedgerEntry, compose
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.effects.face_load_distribution import FaceLoadDistribution
from fe_contact.effects.finite_width import FiniteWidth
from fe_contact.effects.registry import EFFECTS

__all__ = [
    "EFFECTS",
    "ContactScene",
    "Effect",
    "FaceLoadDistribution",
    "FiniteWidth",
    "LedgerEntry",
    "Verdict",
    "compose",
]
