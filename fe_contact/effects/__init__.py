"""Effects: optional physics of the contact analysis, used where a scene calls for it."""

from fe_contact.effects.composer import LedgerEntry, acting, compose, contributed
from fe_contact.effects.effect import ContactScene, Effect, Verdict, named
from fe_contact.effects.registry import EFFECTS

__all__ = [
    "EFFECTS",
    "ContactScene",
    "Effect",
    "LedgerEntry",
    "Verdict",
    "acting",
    "compose",
    "contributed",
    "named",
]
