"""Pressure over the unrolled flank, between what was computed."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.types import FloatArray

ROWS = 96  # along the profile
_SAME = 0.01  # of the mean distance of contacts; nearer ones, as on a tip edge, stand on one place


def pressure_map(flanks: LoadDistribution, roll: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return roll lengths (R,), m, and the largest pressure (R, K), Pa, that passes over a flank there.

    Along the profile the pressure is interpolated between the contacts at neighboring positions, at every
    face position by itself. Contacts on the path and those of either tip edge pass one after the other.

    Parameters
    ----------
    flanks : LoadDistribution
    roll : ndarray, shape (P, N, K)
        Roll lengths on this flank, m.
    """
    on_path, edge = flanks.on_path, ~flanks.on_path & (flanks.force > 0.0)
    touched = roll[on_path | edge]
    low, high = float(touched.min()), float(touched.max())
    lower = roll < 0.5 * (low + high)
    rows = np.linspace(low, high, ROWS if high > low else 1)
    pressure = np.zeros((rows.size, flanks.face_position.size))
    for part in (on_path, edge & lower, edge & ~lower):
        if part.any():
            ends = float(roll[part].min()), float(roll[part].max())
            for k in np.flatnonzero(part.any(axis=(0, 1))):
                here = part[:, :, k]
                passing = _between(rows, roll[:, :, k][here], flanks.pressure[:, :, k][here], ends)
                pressure[:, k] = np.maximum(pressure[:, k], passing)
    return rows, pressure


def _between(
    rows: FloatArray, roll: FloatArray, pressure: FloatArray, ends: tuple[float, float]
) -> FloatArray:
    """Interpolate a pressure between the places (n,) where it is known, held to both ends, 0 beyond."""
    place = _SAME * (ends[1] - ends[0]) / roll.size or 1.0
    knots, index = np.unique(np.round((roll - ends[0]) / place), return_inverse=True)
    largest = np.zeros(knots.size)
    np.maximum.at(largest, index, pressure)
    reached = (rows >= ends[0]) & (rows <= ends[1])
    return np.asarray(np.where(reached, np.interp(rows, ends[0] + place * knots, largest), 0.0))
