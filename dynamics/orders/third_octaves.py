"""Levels in bands of one third of an octave."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import at_least
from dynamics.errors import InputError
from dynamics.orders.waterfall import Waterfall
from dynamics.types import FloatArray, IntArray

LEAST_LINES = 3.0
"""Lines in the narrowest band: below, a band holds what leaks from its neighbors."""
REFERENCE = 1000.0  # Hz, the center of band 0
SHARE = 10.0**0.05 - 10.0**-0.05  # width of a band over its center
NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)


@dataclass(frozen=True)
class ThirdOctaves:
    """The rms of a signal in bands of one third of an octave (IEC 61260-1, base ten) along a run.

    The bands add up the lines of spectra, so that their mean squares add up to the signal's; they are not
    the filters of the standard, which overlap.

    Attributes
    ----------
    band : (K,) int array
        Number of each band, 0 at 1 kHz.
    edges : (K + 1,) array
        Hz.
    rms : (..., B, K) array
        In `unit`, of each block of the run.
    unit : str
    """

    band: IntArray
    edges: FloatArray
    rms: FloatArray
    unit: str

    @property
    def nominal(self) -> FloatArray:
        """The nominal center frequencies in Hz, (K,)."""
        return nominal_center(self.band)


def band_number(frequency: FloatArray) -> IntArray:
    """Return the band that holds each frequency in Hz, above zero; 0 is the one about 1 kHz."""
    return np.asarray(np.floor(10.0 * np.log10(frequency / REFERENCE) + 0.5).astype(int))


def nominal_center(band: IntArray) -> FloatArray:
    """Return the nominal center frequencies of bands by their numbers, Hz."""
    decades, thirds = np.divmod(band, 10)
    return np.asarray(REFERENCE * 10.0 ** decades.astype(float) * np.array(NOMINAL)[thirds])


def third_octaves(blocks: Waterfall, top: float) -> ThirdOctaves:
    """Add up the lines of spectra over frequency in the bands that end at or below `top`, Hz.

    Raises
    ------
    InputError
        If no band below `top` holds three lines.
    """
    power = 0.5 * blocks.amplitude[..., 1:] ** 2 / blocks.noise_bandwidth
    band, edges, within = band_sums(float(blocks.line[1]), power, top)
    return ThirdOctaves(band, edges, np.sqrt(within), blocks.unit)


def band_sums(
    width: float, power: FloatArray, top: float, bottom: float = 0.0
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return bands (J,), their edges (J + 1,) in Hz and the sums (..., J) of lines of a spectrum in them.

    A line's power is spread evenly over its width, so that a band edge divides it.

    Parameters
    ----------
    width : float
        Distance of the lines, Hz.
    power : (..., K) array
        Of the lines at 1, 2, ... K times it.
    top, bottom : float
        Edges that no band crosses, Hz.

    Raises
    ------
    InputError
        If no band between them holds three lines.
    """
    least = max(LEAST_LINES * width / SHARE, bottom * 10.0**0.05)
    low = int(np.ceil(10.0 * np.log10(least / REFERENCE)))
    last = width * power.shape[-1]
    high = int(np.floor(10.0 * np.log10(min(top, last) / REFERENCE) - 0.5))
    band = np.arange(low, high + 1)
    if not band.size:
        bound = at_least(REFERENCE * 10.0 ** (0.1 * (low + 0.5)), "Hz")
        raise InputError("top", top, bound, "Longer blocks have narrower lines.")
    edges = REFERENCE * 10.0 ** ((np.append(band, band[-1] + 1) - 0.5) / 10.0)
    below = np.concatenate([np.zeros_like(power[..., :1]), np.cumsum(power, axis=-1)], axis=-1)
    at = np.clip(edges / width - 0.5, 0.0, power.shape[-1])
    whole = np.minimum(at.astype(int), power.shape[-1] - 1)
    under = below[..., whole] + (at - whole) * power[..., whole]
    return band, edges, np.maximum(np.diff(under, axis=-1), 0.0)
