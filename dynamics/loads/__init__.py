"""Forces and unbalances of a scene: declared fields, light."""

from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.unbalance import Unbalance

__all__ = ["AppliedForce", "Unbalance"]
