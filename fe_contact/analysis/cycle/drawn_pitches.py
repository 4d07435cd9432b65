"""Errors of derivatives over a cycle, from pitches that were drawn and solved."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    HARMONICS,
    MEAN,
    OFF_MESH,
    PEAK_TO_PEAK,
    QUANTITIES,
)
from fe_contact.ste.interpolation import Axis
from fe_contact.types import FloatArray
from host.optional_modules import scipy

CONFIDENCE = 0.99
"""Confidence of Student's distribution for means over drawn pitches. A few pitches have much larger errors
than most others: a confidence of 0.95 covers only 91 % of 160 quantities of drawn gears.
"""


@dataclass(frozen=True)
class DrawnPitches:
    """Errors of tangents in C drawn pitches, at P positions and L loads."""

    tangent_error: FloatArray
    """Error of transmission error, or of the load arm: value by the tangents of all other states less the
    solved value, m. Shape (C, P, L).
    """
    position: FloatArray
    """Position in the base pitch, in [0, 1). Shape (P,)."""

    @property
    def correction(self) -> FloatArray:
        """Mean error of the tangents at every position (P, L), m; positive where tangents lie above."""
        return np.asarray(self.tangent_error.mean(axis=0))

    @property
    def error(self) -> FloatArray:
        """Largest error of a position of a drawn pitch (L,), m, once the mean is taken off."""
        return np.asarray(np.abs(self._left).max(axis=(0, 1)))

    @property
    def quantity_errors(self) -> FloatArray:
        """Errors of mean, peak-to-peak, orders beside the mesh and mesh harmonics (23, L), m.

        Of what repeats at every pitch that of the mean of so many drawn ones. Peak-to-peak is bounded by the
        envelope, which knows where it is largest: NaN here. All orders beside the mesh share the energy of
        what pitches are missed by (Parseval), so none is larger than the root of twice the mean square.
        """
        count, left = len(self.tangent_error), self._left
        of_mean = scipy.stats.t.ppf(0.5 + 0.5 * CONFIDENCE, count - 1) / math.sqrt(count)
        spacing = Axis(self.position, 1.0).spacing
        weight = 0.5 * (spacing + np.roll(spacing, 1))
        waves = np.exp(-2.0j * math.pi * np.arange(1, HARMONICS + 1)[:, None] * self.position)
        lines = np.einsum("hp,cpl->chl", waves * weight, left) * 2.0
        errors = np.empty((QUANTITIES, left.shape[2]))
        errors[MEAN] = of_mean * np.einsum("p,cpl->cl", weight, left).std(axis=0, ddof=1)
        errors[PEAK_TO_PEAK] = np.nan
        errors[OFF_MESH] = np.sqrt(2.0 * np.einsum("p,cpl->l", weight, left**2) / count)
        errors[FIRST_HARMONIC:] = of_mean * np.sqrt((np.abs(lines) ** 2).sum(axis=0) / (count - 1))
        return errors

    @property
    def _left(self) -> FloatArray:
        return np.asarray(self.tangent_error - self.correction)
