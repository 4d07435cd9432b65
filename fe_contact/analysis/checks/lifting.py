"""Gaps by which deviations of the teeth in mesh can lift or lower the transmission error."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.flank.extent import Extent
from fe_contact.types import FloatArray, IntArray


def deviations_in_mesh(point: OperatingPoint, position: FloatArray, pair: IntArray) -> Extent:
    """Return bounds of the gaps of all pairs (N,) at positions (P,), arrays (P,), and of their slopes.

    Parameters
    ----------
    position : ndarray, shape (P,)
        Base pitches from 0 on.
    pair : ndarray of int, shape (N,)
        Indices of the pairs, counted anew at every whole pitch.
    """
    pitches, of_pitch = np.unique(np.floor(position).astype(np.int64), return_inverse=True)
    extent = point.model.extent(point.contact.pair, pitches[:, None] - pair)
    low, high, slope = np.asarray(extent.low), np.asarray(extent.high), np.asarray(extent.slope)
    return Extent(low.min(axis=1), high.max(axis=1), slope.max(axis=1)).at(of_pitch)
