"""Joints of the bodies: couplings, rotations imposed and free, housings."""

from dynamics.joints.coupling import Coupling
from dynamics.joints.free_rotation import FreeRotation
from dynamics.joints.housing import Housing, read_housing
from dynamics.joints.imposed_rotation import ImposedRotation

__all__ = [
    "Coupling",
    "FreeRotation",
    "Housing",
    "ImposedRotation",
    "read_housing",
]
