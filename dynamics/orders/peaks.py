"""Peaks of a spectrum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.orders.spectrum import Spectrum


@dataclass(frozen=True)
class Peak:
    """A local maximum of a spectrum.

    Attributes
    ----------
    frequency : float
        Hz, between the lines: the vertex of the parabola through the logarithms of the three highest.
    amplitude : float
        At that vertex, in the spectrum's unit: within 3 % for a sinusoid under a Hann window.
    """

    frequency: float
    amplitude: float


def find_peaks(
    spectrum: Spectrum, count: int = 10, low: float = 0.0, high: float = np.inf
) -> tuple[Peak, ...]:
    """Return the `count` highest peaks between `low` and `high` (Hz), highest first; the mean is none.

    Raises
    ------
    InputError
        If the spectrum holds more than one signal.
    """
    lines = spectrum.amplitude
    if lines.ndim != 1:
        raise InputError(
            "spectrum.amplitude", lines.shape, "of one signal, (K,)", "Pick one bearing and direction."
        )
    inner = np.arange(2, lines.size - 1)
    inside = (spectrum.frequency[inner] >= low) & (spectrum.frequency[inner] <= high)
    tops = inner[inside & (lines[inner] > lines[inner - 1]) & (lines[inner] >= lines[inner + 1])]
    tops = tops[np.argsort(lines[tops])[::-1][:count]]
    return tuple(_vertex(spectrum, int(top)) for top in tops)


def _vertex(spectrum: Spectrum, top: int) -> Peak:
    """Parabola through the logarithms of three lines."""
    left, middle, right = np.log(np.maximum(spectrum.amplitude[top - 1 : top + 2], 1e-300))
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    height = middle - 0.25 * (left - right) * shift
    return Peak(float(spectrum.frequency[top] + shift * spectrum.resolution), float(np.exp(height)))
