"""Ablation of a scene: every effect switched over by itself, beside what the ledger says it is worth."""

from dynamics.ablation.ablate import Ablation, EffectAblation, ablate
from dynamics.ablation.figures import RunFigures

__all__ = ["Ablation", "EffectAblation", "RunFigures", "ablate"]
