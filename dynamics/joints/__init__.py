"""Joints of the bodies, bushings to the ground and pins in a carrier, and their drives."""

from dynamics.joints.bearing_stiffness import BearingStiffness
from dynamics.joints.bushing import Bushing
from dynamics.joints.coupling import Coupling
from dynamics.joints.free_rotation import FreeRotation
from dynamics.joints.housing import Housing, read_housing
from dynamics.joints.imposed_rotation import ImposedRotation
from dynamics.joints.planet_bearing import PlanetBearing
from dynamics.joints.rolling_bearing import RollingBearing

__all__ = [
    "BearingStiffness",
    "Bushing",
    "Coupling",
    "FreeRotation",
    "Housing",
    "ImposedRotation",
    "PlanetBearing",
    "RollingBearing",
    "read_housing",
]
