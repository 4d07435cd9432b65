"""Influence of effects, estimated without finite elements: teeth as Weber and Banaschek's springs."""

from fe_contact.effects.worth.estimate import Worth, estimate_worth, estimate_worths
from fe_contact.effects.worth.influence import Influence

__all__ = ["Influence", "Worth", "estimate_worth", "estimate_worths"]
