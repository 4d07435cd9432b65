"""Influence of dynamic effects by linear theory before integration; the decision of "auto"."""

from dynamics.influence.neglected_check import Decided, Influence, decide_effects, estimate_influences

__all__ = ["Decided", "Influence", "decide_effects", "estimate_influences"]
