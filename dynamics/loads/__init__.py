"""Loads and drives: laws of time, speed and angle, torques, applied forces, unbalances."""

from dynamics.loads.applied_force import AppliedForce, LoadTorque, Unbalance
from dynamics.loads.load_course import BySpeed, Orders, SpeedCurve
from dynamics.loads.time_law import AngleLaw, TimeLaw

__all__ = [
    "AngleLaw",
    "AppliedForce",
    "BySpeed",
    "LoadTorque",
    "Orders",
    "SpeedCurve",
    "TimeLaw",
    "Unbalance",
]
