"""Bearings: rolling elements by geometry, bushings, what they do to a seat, their laws, loads and life."""

from dynamics.bearings.elliptic_contact import EllipticContact
from dynamics.bearings.rolling_bearing import BallBearing, CatalogLine, RollerBearing, RollingBearing
from dynamics.bearings.seat import BearingStiffness, Bushing, PlanetBearing

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
