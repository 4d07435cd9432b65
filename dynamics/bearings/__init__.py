"""Bearings: rolling elements by geometry, bushings, what they do to a seat, their laws, loads and life."""

from dynamics.bearings.ball_bearing import BallBearing, EllipticContact
from dynamics.bearings.bearing_stiffness import BearingStiffness
from dynamics.bearings.bushing import Bushing
from dynamics.bearings.planet_bearing import PlanetBearing
from dynamics.bearings.roller_bearing import RollerBearing
from dynamics.bearings.rolling_bearing import RollingBearing
from dynamics.bearings.row import CatalogLine

__all__ = [
    "BallBearing",
    "BearingStiffness",
    "Bushing",
    "CatalogLine",
    "EllipticContact",
    "PlanetBearing",
    "RollerBearing",
    "RollingBearing",
]
