"""Force elements: the list of all laws, their compiled evaluation, terms of rotating frames."""

from dynamics.bearings.rolling_contact import RollingContact
from dynamics.bearings.spring_curve import SpringCurve
from dynamics.loads.applied_force import SpeedTorque

__all__ = [
    "RollingContact",
    "SpeedTorque",
    "SpringCurve",
]
