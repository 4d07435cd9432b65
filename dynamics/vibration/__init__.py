"""Vibration of housings under the forces of their bearings."""

from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.seat_forces import seat_forces

__all__ = ["housing_motion", "seat_forces"]
