"""Loads and drives: laws of time, speed and angle, torques, applied forces, unbalances."""

from dynamics.loads.angle_law import AngleLaw
from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.load_course import BySpeed, Orders
from dynamics.loads.load_torque import LoadTorque
from dynamics.loads.speed_curve import SpeedCurve
from dynamics.loads.time_law import TimeLaw
from dynamics.loads.unbalance import Unbalance

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
