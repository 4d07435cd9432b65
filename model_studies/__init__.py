"""Studies of a model by its variants: the accuracy study over fidelities, the ablation over effects.

And what both libraries share beside: what predictions of cost know of the host, progress, records in files.

A library hands in what its variants compute and by which figures they are compared.
"""

from __future__ import annotations

from model_studies.ablation import Ablation, EffectAblation, Figures
from model_studies.frontier import (
    Fidelity,
    FidelityResult,
    Frontier,
    Outcome,
    against_finest,
    front_of,
    knee_above,
    knee_of,
    run_fidelities,
)
from model_studies.progress import Progress, silent
from model_studies.record import NOT_STORED, in_unit
from model_studies.variants import LeftOut, run_variants

__all__ = [
    "NOT_STORED",
    "Ablation",
    "EffectAblation",
    "Fidelity",
    "FidelityResult",
    "Figures",
    "Frontier",
    "LeftOut",
    "Outcome",
    "Progress",
    "against_finest",
    "front_of",
    "in_unit",
    "knee_above",
    "knee_of",
    "run_fidelities",
    "run_variants",
    "silent",
]
