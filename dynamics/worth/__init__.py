"""What dynamic effects are worth by linear theory, before anything is integrated; what "auto" makes of it."""

from dynamics.worth.decide import Decided, decide_effects
from dynamics.worth.estimate import Worth, estimate_worths

__all__ = ["Decided", "Worth", "decide_effects", "estimate_worths"]
