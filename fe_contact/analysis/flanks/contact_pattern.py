"""Contact pattern: the largest pressure that each point of the unrolled flank meets over the mesh cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class ContactPattern:
    """Largest pressure over one flank.

    Attributes
    ----------
    roll_length : ndarray, shape (R,)
        Middles of equal cells along the profile, m.
    face_position : ndarray, shape (K,)
        Middles of the slices, as distances from the pinion's mid-face, m.
    pressure : ndarray, shape (R, K)
        Largest Hertz pressure in Pa of any pair at any position; 0 where nothing touches.
    """

    roll_length: FloatArray
    face_position: FloatArray
    pressure: FloatArray


def contact_pattern(
    distribution: LoadDistribution, gear: Literal["pinion", "wheel"] = "pinion"
) -> ContactPattern:
    """Collect the pressures of all positions and pairs on one flank.

    The cells are as long as the flanks roll between two positions, so that over a whole cycle of equally
    spaced positions the contact line meets every cell.

    Parameters
    ----------
    distribution : LoadDistribution
        At equally spaced positions over one base pitch.
    gear : str
        "pinion" or "wheel": whose flank.
    """
    roll = distribution.roll_length_1 if gear == "pinion" else distribution.roll_length_2
    touched = distribution.on_path | (distribution.force > 0.0)
    low, high = float(roll[touched].min()), float(roll[touched].max())
    span = high - low or 1.0  # a single point is a cell of its own
    count = max(int(span / _step(distribution, roll)), 1)
    cell = np.clip(((roll - low) * (count / span)).astype(int), 0, count - 1)
    pressure = np.zeros((count, distribution.face_position.size))
    index = np.nonzero(touched)
    np.maximum.at(pressure, (cell[index], index[2]), distribution.pressure[index])
    middles = np.asarray(low + (np.arange(count) + 0.5) * (span / count), dtype=np.float64)
    return ContactPattern(middles, distribution.face_position, pressure)


def _step(distribution: LoadDistribution, roll: FloatArray) -> float:
    """Longest way in m that a contact on the path rolls from one position to the next."""
    both = distribution.on_path[1:] & distribution.on_path[:-1]
    ways = np.abs(np.diff(roll, axis=0))[both]
    return float(ways.max()) if ways.size else np.inf
