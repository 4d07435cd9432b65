"""The load of a pair of teeth along the face, from forces on hats."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray, IntArray

_SAMPLES = 4001
"""Places of a load over the face between which its means are searched."""


@dataclass(frozen=True)
class LineLoad:
    """Load of a pair of teeth along the face, linear between stations."""

    ahead: int
    """Pair index."""
    face_position: FloatArray
    """Distance from mid-face, m. Shape (k,)."""
    load: FloatArray
    """Normal force per length of contact line, N/m. Shape (k,)."""

    def largest_mean(self, length: float) -> float:
        """Return the largest mean over a length of the face within the stations, N/m."""
        face = np.linspace(self.face_position[0], self.face_position[-1], _SAMPLES)
        load = np.interp(face, self.face_position, self.load)
        force = np.concatenate([[0.0], np.cumsum(0.5 * (load[1:] + load[:-1]) * np.diff(face))])
        start = np.linspace(face[0], face[-1] - length, _SAMPLES)
        within = np.interp(start + length, face, force) - np.interp(start, face, force)
        return float(within.max() / length)


def line_loads(ahead: IntArray, face: FloatArray, force: FloatArray) -> tuple[LineLoad, ...]:
    """Return the line loads of pairs from forces (h,) in N on hats at face positions (h,), m.

    Forces are those along the face: per unit of the contact line's projection on the axis.
    """
    loads = []
    for pair in np.unique(ahead):
        stations, number = np.unique(face[ahead == pair], return_inverse=True)
        between = np.diff(stations)
        width = 0.5 * (np.append(between, 0.0) + np.insert(between, 0, 0.0))
        loads.append(LineLoad(int(pair), stations, np.bincount(number, force[ahead == pair]) / width))
    return tuple(loads)
