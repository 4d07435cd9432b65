"""Contact pattern: the largest pressure that each point of the unrolled flank meets over the mesh cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bounds.brief import brief
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.types import FloatArray


@brief
@dataclass(frozen=True)
class ContactPattern:
    """Largest pressure over one flank."""

    roll_length: FloatArray
    """Middles of equal cells along the profile, m. Shape (R,)."""
    face_position: FloatArray
    """Middles of the slices, as distances from the pinion's mid-face, m. Shape (K,)."""
    pressure: FloatArray
    """Largest Hertz pressure in Pa of any pair at any position; 0 where nothing touches. Shape (R, K)."""


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
    both = distribution.on_path[1:] & distribution.on_path[:-1]
    steps = np.abs(np.diff(roll, axis=0))[both]
    count = max(int(span / float(steps.max())), 1) if steps.size else 1
    cell = np.clip(((roll - low) * (count / span)).astype(int), 0, count - 1)
    pressure = np.zeros((count, distribution.face_position.size))
    index = np.nonzero(touched)
    np.maximum.at(pressure, (cell[index], index[2]), distribution.pressure[index])
    middles = np.asarray(low + (np.arange(count) + 0.5) * (span / count), dtype=np.float64)
    return ContactPattern(middles, distribution.face_position, pressure)
