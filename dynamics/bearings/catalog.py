"""The internal geometry of a deep groove ball bearing, estimated from its line in a catalog.

Balls of n and D follow from two relations: the static load rating C_0 = f_0(D/D_pw) n D^2 [1]_, and the balls
that can be put between eccentric rings, which fill 187.5 degrees of the circle from the first center to the
last. That angle is the middle of the 184 to 192 degrees of five bearings of 17 to 25 mm bore whose geometry
is published; f_0 gives their ratings to 1.3 %.

References
----------
.. [1] ISO 76:2006, Rolling bearings - Static load ratings, table 1: f_0 of radial ball bearings, in N/mm^2.
   By its definition, 4200 MPa in the heaviest contact, exact integrals give 2.6 to 3.2 % less at all D/D_pw.
"""

from __future__ import annotations

import math

import numpy as np

from bounds import from_to
from dynamics.bearings.rolling_bearing import BallBearing, CatalogLine
from dynamics.errors import InputError
from host.optional_modules import scipy

SLENDERNESS = (0.0, 0.09, 0.1, 0.11, 0.12, 0.15, 0.2, 0.25, 0.3)
"""Ball diameter over pitch diameter, at which `RATING` has values."""
RATING = (14.7e6, 16.5e6, 16.4e6, 16.1e6, 15.9e6, 15.2e6, 14.0e6, 12.8e6, 11.6e6)
"""f_0, Pa, linear between its values."""
FILLED = math.radians(187.5)  # angle from the first center to the last
NUMBERS = range(5, 41)  # of balls
WALL = 0.75
"""Upper bound of the ball diameter over the section's height, bore to outside; measured: 0.58 to 0.62."""

BAND = {"count": 0.0, "diameter": 0.01, "pitch_diameter": 0.035, "displacement": 0.125}
"""Largest relative errors on these five bearings.

The displacement is radial, without clearance, at C_0/10. Its error is mostly that of the grooves, which no
catalog states: from 0.515 at both rings to 0.53 and 0.54. With the grooves known it is 0.002.
"""


def from_catalog(
    bore: float, outside_diameter: float, static_rating: float, clearance: float = 0.0
) -> BallBearing:
    """Return the deep groove ball bearing that a line of a catalog most likely describes.

    Grooves are those of ISO/TS 16281, 0.52 and 0.53; see `BAND` for how far the rest may be off. Raises
    `InputError`: a value is out of its bounds, or no number of balls fits rating and section.

    Parameters
    ----------
    bore, outside_diameter : float
        m.
    static_rating : float
        C_0, N.
    clearance : float
        Radial internal clearance, m; no catalog line states it.
    """
    CatalogLine(bore, outside_diameter, static_rating, clearance)
    pitch, largest = (bore + outside_diameter) / 2.0, WALL * (outside_diameter - bore) / 2.0
    # of the greatest number of balls, which are the smallest
    smallest = pitch * math.sin(FILLED / (2.0 * (NUMBERS[-1] - 1)))
    minimum, maximum = (_filled_rating(diameter, pitch) for diameter in (smallest, largest))
    if not minimum <= static_rating <= maximum:
        suggestion = "Check its unit: no deep groove ball bearing of this section has such a rating."
        raise InputError("static_rating", static_rating, from_to(minimum, maximum, "N"), suggestion)
    choices = [(count, _diameter(count, pitch, static_rating)) for count in NUMBERS]
    count, diameter = min(choices, key=lambda row: abs(_filled(row[0], row[1], pitch) - FILLED))
    return BallBearing(count, diameter, pitch, clearance=clearance)


def _filled(count: int, diameter: float, pitch: float) -> float:
    """Return the angle that balls side by side fill, from the first center to the last, rad."""
    return 2.0 * (count - 1) * math.asin(diameter / pitch)


def _filled_rating(diameter: float, pitch: float) -> float:
    """Return C_0 of as many balls as fill the usual angle, fractions of a ball included, N."""
    return (1.0 + FILLED / _filled(2, diameter, pitch)) * _rating(diameter, pitch) * diameter**2


def _rating(diameter: float, pitch: float) -> float:
    """Return f_0, Pa."""
    return float(np.interp(diameter / pitch, SLENDERNESS, RATING))


def _diameter(count: int, pitch: float, static_rating: float) -> float:
    """Return the diameter of `count` balls that have this rating, m; at most that of the circle."""

    def residual(diameter: float) -> float:
        return count * _rating(diameter, pitch) * diameter**2 - static_rating

    return float(scipy.optimize.brentq(residual, 0.0, pitch, xtol=1e-12)) if residual(pitch) > 0.0 else pitch
