"""Influence of effects, estimated without finite elements: teeth as Weber and Banaschek's springs."""

from fe_contact.effects.influence.deflection_budget import DeflectionBudget, deflection_budget
from fe_contact.effects.influence.estimate import (
    EstimatedInfluence,
    Influence,
    estimate_influence,
    estimate_influences,
)

__all__ = [
    "DeflectionBudget",
    "EstimatedInfluence",
    "Influence",
    "deflection_budget",
    "estimate_influence",
    "estimate_influences",
]
