"""Slices of the common face width: where along the face contact is looked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class Slices:
    """Slices of equal width over the common face width.

    Attributes
    ----------
    center : ndarray, shape (K,)
        Distance of the middle of each slice from the pinion's mid-face, m.
    width : float
        Along the face, m.
    """

    center: FloatArray
    width: float

    @classmethod
    def of_pair(cls, pair: ParallelAxes, count: int) -> Slices:
        """Divide the common face width of `pair` into `count` slices; one slice is the plane model."""
        width = pair.face_width / count
        center = pair.common_face_center + (np.arange(count) - 0.5 * (count - 1)) * width
        return cls(np.asarray(center, dtype=float), width)
