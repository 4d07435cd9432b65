"""Optional physics of the multibody model: one effect per file, a registry, a ledger."""

from dynamics.system.effects.effect import FREEDOMS, Effect, MeshOnRotor, SupportedRotor, Verdict
from dynamics.system.effects.registry import EFFECTS, LEFT_OUT

__all__ = ["EFFECTS", "FREEDOMS", "LEFT_OUT", "Effect", "MeshOnRotor", "SupportedRotor", "Verdict"]
