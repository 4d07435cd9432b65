"""Rating life of a bearing from the loads of its elements, by ISO/TS 16281.

Only for steel bearings of good quality; lubrication and contamination (the modified life) are not in it.

References
----------
.. [2] ISO/TS 16281:2008, Rolling bearings - Methods for calculating the modified reference rating life for
   universally loaded bearings, 4.3 (balls, equations 19 to 30) and 5.3 (rollers, equations 47 to 66), of
   radial bearings of one row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.bearings import BallBearing, RollerBearing
from dynamics.checks import positive
from dynamics.types import FloatArray

BALL_RINGS, ROLLER_RINGS = (0.407, 0.389), (0.378, 0.364)  # of [2]_: inner, outer ring of radial bearings
ROLLER_QUALITY = 0.83  # lambda nu: contained in C, but no more once edge loads are computed


@dataclass(frozen=True)
class _RatingLife:
    """The basic reference rating life."""

    revolutions: float
    """L_10r, that 90 % of bearings reach; infinite where nothing is loaded."""
    equivalent_load: float
    """P_ref, N: the radial load of the same life by ISO 281."""


def rating_life(bearing: BallBearing | RollerBearing, load: FloatArray, rating: float) -> _RatingLife:
    """Return the life of `bearing`, whose inner ring turns against a constant load.

    Raises `InputError`: the rating is not positive.

    Parameters
    ----------
    load : (Z, L) array
        Normal loads of the elements, N, see `Reaction`.
    rating : float
        Basic dynamic load rating C, N.
    """
    positive("rating", rating)
    ball = isinstance(bearing, BallBearing)
    slope = 10.0 / 3.0 if ball else 4.5  # product of Weibull slope and load exponent
    # exponents of the mean load: of the inner ring, which turns against the load, and of the outer ring
    exponents = (3.0, slope) if ball else (4.0, slope)
    if isinstance(bearing, BallBearing):
        limits = _ball_ratings(bearing, rating)
    else:
        limits = _lamina_ratings(bearing, rating)
    stressed = load if ball else load * _edge_factor(load.shape[1])
    damage = 0.0  # of both rings and all laminae; their probabilities of survival multiply
    for limit, exponent in zip(limits, exponents, strict=True):
        equivalent = np.mean(stressed**exponent, axis=0) ** (1.0 / exponent)
        damage += float(np.sum((equivalent / limit) ** slope))
    power = 3.0 if ball else 10.0 / 3.0  # load exponent of the life of the bearing
    life = damage ** (-power / slope) if damage > 0.0 else math.inf
    return _RatingLife(1e6 * life, rating * life ** (-1.0 / power))


def _ball_ratings(bearing: BallBearing, rating: float) -> tuple[float, float]:
    """Return the element loads that belong to C at the inner and at the outer ring, N."""
    share = bearing.slenderness
    inner, outer = bearing.inner_groove, bearing.outer_groove
    osculation = inner / outer * (2.0 * outer - 1.0) / (2.0 * inner - 1.0)
    ratio = 1.044 * ((1.0 - share) / (1.0 + share)) ** 1.72 * osculation**0.41
    element_rating = rating / (bearing.count * math.cos(bearing.contact_angle) ** 0.7)
    return _ring_ratings(element_rating, ratio, BALL_RINGS, 10.0 / 3.0)


def _lamina_ratings(bearing: RollerBearing, rating: float) -> tuple[float, float]:
    """Return the loads of a lamina that belong to C at the inner and at the outer ring, N."""
    share = bearing.slenderness
    ratio = 1.038 * ((1.0 - share) / (1.0 + share)) ** (143.0 / 108.0)
    element_rating = rating / (ROLLER_QUALITY * bearing.count * math.cos(bearing.contact_angle))
    return _ring_ratings(element_rating * bearing.laminae ** (-7.0 / 9.0), ratio, ROLLER_RINGS, 4.5)


def _ring_ratings(
    rating: float, ratio: float, constants: tuple[float, float], slope: float
) -> tuple[float, float]:
    """Return the ratings of inner and outer ring, N, which together give `rating` and have the `ratio`."""
    inner = rating / constants[0] * (1.0 + ratio**slope) ** (1.0 / slope)
    outer = rating / constants[1] * (1.0 + ratio**-slope) ** (1.0 / slope)
    return inner, outer


def _edge_factor(laminae: int) -> FloatArray:
    """Return the rise of stress towards the ends of a roller, (laminae,): equation 60 of [2]_."""
    if laminae == 1:
        return np.ones(1)
    coordinate = np.abs(2.0 * np.arange(1, laminae + 1) - laminae - 1.0) / (2.0 * laminae - 2.0)
    with np.errstate(divide="ignore"):  # in the very middle the logarithm is infinite: no rise
        return np.asarray(1.0 - 0.01 / np.log(1.985 * coordinate))
