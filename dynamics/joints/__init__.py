"""Joints of the bodies: couplings, rotations imposed and free, housings."""

from dynamics.joints.coupling import Coupling
from dynamics.joints.housing import Housing, read_housing
from dynamics.joints.rotations import FreeRotation, ImposedRotation

__all__ = [
    "Coupling",
    "FreeRotation",
    "Housing",
    "ImposedRotation",
    "read_housing",
]
