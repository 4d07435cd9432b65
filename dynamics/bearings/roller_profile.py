"""Profiles of rollers, and the stiffness of their laminae, by ISO/TS 16281.

References
----------
.. [1] ISO/TS 16281:2008, Rolling bearings - Methods for calculating the modified reference rating life for
   universally loaded bearings, equations (34) and (42) to (44).
"""

from __future__ import annotations

import numpy as np

from dynamics.types import FloatArray

LOGARITHMIC, CROWNED, STRAIGHT = "logarithmic", "crowned", "straight"
PROFILES = (LOGARITHMIC, CROWNED, STRAIGHT)
LINE_STIFFNESS = 35948e6  # N/m^2: 35948 N/mm^2 of [1]_, of steel rollers between steel raceways
LONG = 2.5  # diameters: longer cylindrical rollers are straight in their middle


def lamina_places(length: float, laminae: int) -> FloatArray:
    """Return the middles of equal laminae along a roller of `length` (m), (laminae,), m from its middle."""
    return np.asarray((np.arange(laminae) + 0.5) / laminae - 0.5) * length


def lamina_stiffness(length: float, laminae: int) -> float:
    """Return c of one lamina of a roller of `length` (m), N/m^(10/9): both contacts in series [1]_."""
    return float(LINE_STIFFNESS * length ** (8.0 / 9.0) / laminae)


def logarithmic_drop(place: FloatArray, diameter: float, length: float, tapered: bool) -> FloatArray:
    """Return how far the logarithmic profile [1]_ of a roller lies below its middle at `place`, m.

    Diameter and effective length in m.
    """
    straight = 0.0 if tapered or length <= LONG * diameter else length - LONG * diameter
    factor = 0.00045 if tapered else 0.0005 if straight > 0.0 else 0.00035
    ratio = np.maximum(2.0 * np.abs(place) - straight, 0.0) / (length - straight)
    return np.asarray(-factor * diameter * np.log1p(-(ratio**2)))


def crowned_drop(place: FloatArray, crown: float, length: float) -> FloatArray:
    """Return how far a circular crowning lies below its middle at `place`, m; `crown` (m) at the ends."""
    return np.asarray(crown * (2.0 * place / length) ** 2)
