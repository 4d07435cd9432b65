"""Vibration of housings under the forces of their bearings."""

from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.motion_quantity import MotionQuantity
from dynamics.vibration.points import named_points
from dynamics.vibration.seat_forces import run_seat_forces, seat_forces
from dynamics.vibration.time_signal import motion_signal, point_signal

__all__ = [
    "MotionQuantity",
    "housing_motion",
    "motion_signal",
    "named_points",
    "point_signal",
    "run_seat_forces",
    "seat_forces",
]
