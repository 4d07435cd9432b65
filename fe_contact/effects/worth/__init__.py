"""What effects are worth, estimated without finite elements: teeth as Weber and Banaschek's springs."""

from fe_contact.effects.worth.estimate import Worth, estimate_worth, estimate_worths

__all__ = ["Worth", "estimate_worth", "estimate_worths"]
