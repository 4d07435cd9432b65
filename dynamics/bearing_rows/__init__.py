"""Rows of rolling elements by their geometry: balls in grooves, rollers with a profile, a catalog line."""

from dynamics.bearing_rows.ball_bearing import BallBearing, EllipticContact
from dynamics.bearing_rows.catalog_line import CatalogLine
from dynamics.bearing_rows.locating import RollerBearing

__all__ = ["BallBearing", "CatalogLine", "EllipticContact", "RollerBearing"]
