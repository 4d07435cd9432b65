"""Kinds of force laws by number, as compiled functions tell them apart."""

from __future__ import annotations

from enum import IntEnum


class Law(IntEnum):
    """Kinds of force laws."""

    FLANK = 0  # p = 1: a flank in contact, from its table
    SPEED_TORQUE = 1  # p = 1: a torque that depends on a shaft's speed
    ROLLING_CONTACT = 2  # p = 2: a rolling bearing's radial force
    SPRING_CURVE = 3  # p = 1: a bearing's force by displacement in one direction
    SPATIAL_FLANK = 4  # p = 1 to 5: a flank that feels misalignment, center distance, friction
    ROTATING_FRAME = 5  # p = 2 or 3: gyroscopic moments, Coriolis and centripetal terms
    FRAME_COUPLING = 6  # p = 4 or 8: a coupling of shafts in frames that turn against each other
    BALLS = 7  # p = 5: a bearing's row of balls
    ROLLERS = 8  # p = 5: a bearing's row of rollers
    APPLIED_FORCE = 9  # p = 1 to 4: a force on a shaft by time, speed or angle
    UNBALANCE = 10  # p = 3: mass off a shaft's axis
    LINEAR_BEARING = 11  # p = 1 to 5: a linear bearing in a housing that moves


OF_BEARINGS = (Law.ROLLING_CONTACT, Law.SPRING_CURVE, Law.BALLS, Law.ROLLERS, Law.LINEAR_BEARING)
"""Laws of bearings; each is the gradient of an energy without hollows."""
