"""Optional physics of the contact analysis: only what the scene calls for."""

from fe_contact.effects.composer import LedgerEntry, compose
from fe_contact.effects.effect import ContactScene, Effect, Verdict, named
from fe_contact.effects.registry import EFFECTS

__all__ = [
    "EFFECTS",
    "ContactScene",
    "Effect",
    "LedgerEntry",
    "Verdict",
    "compose",
    "named",
]
