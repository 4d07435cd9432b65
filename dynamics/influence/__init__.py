"""Influence of dynamic effects by linear theory before integration; the decision of "auto"."""

from dynamics.influence.assumed_phases import with_assumed_phases
from dynamics.influence.neglected_check import (
    Decision,
    Influence,
    decide_effects,
    estimate_influences,
    response_influences,
)
from dynamics.influence.sized_ledger import neglected_effects, sized_ledger

__all__ = [
    "Decision",
    "Influence",
    "decide_effects",
    "estimate_influences",
    "neglected_effects",
    "response_influences",
    "sized_ledger",
    "with_assumed_phases",
]
