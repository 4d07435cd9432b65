"""Optional physics of the multibody model: one effect per file, a registry, a ledger."""

from dynamics.effects.effect import Effect, MeshEffect, RotorEffect
from dynamics.effects.ledger import EffectLedger
from dynamics.effects.registry import EFFECTS, NEGLECTED

__all__ = ["EFFECTS", "NEGLECTED", "Effect", "EffectLedger", "MeshEffect", "RotorEffect"]
