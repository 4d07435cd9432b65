"""What holds bodies: bushings to the ground, imposed rotation."""

from dynamics.joints.bushing import Bushing
from dynamics.joints.imposed_rotation import ImposedRotation

__all__ = ["Bushing", "ImposedRotation"]
