"""Ablation of a scene: every effect toggled by itself, beside its influence in the ledger."""

from dynamics.ablation.ablate import Ablation, EffectAblation, RunFigures, ablate

__all__ = ["Ablation", "EffectAblation", "RunFigures", "ablate"]
