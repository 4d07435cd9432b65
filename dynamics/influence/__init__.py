"""Influence of dynamic effects by linear theory before integration; the decision of "auto"."""

from dynamics.influence.decide import Decided, decide_effects
from dynamics.influence.estimate import Influence, estimate_influences

__all__ = ["Decided", "Influence", "decide_effects", "estimate_influences"]
