"""Frequencies at which a resistance is computed: as close as its interpolation needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import ModalResistance
from dynamics.acoustics.hull import ComplexArray
from dynamics.types import FloatArray

TOLERANCE = 0.5
"""dB, of the power of each mode in the middle of two frequencies; what is kept is off by a quarter of it."""
NOTHING = 1e-6
"""Resistance over the largest of all modes that counts as none."""
CONSTANT, CONSTANT_ERROR = 1.05, 0.008
"""Ratio of frequencies for R that does not change: R/f^2 is convex, 3/4 (step/f)^2 off in the middle, dB."""
FEWEST, KNOTS = 8.0, (0.9, 0.025)
"""Frequencies of an octave where the body is small beside the wavelength, and more with ka and its square."""
WIDEST, CLOSEST = 1.5, 1.03
"""Largest ratio of frequencies side by side; the smallest that is parted."""


@dataclass(frozen=True)
class Knots:
    """Frequencies (F,) in Hz, matrices (F, r, r), and the largest error in dB between them."""

    frequency: FloatArray
    matrix: ComplexArray
    error: float


def knots_between(
    low: float,
    high: float,
    resistance: Callable[[float], ComplexArray],
    modes: FloatArray,
) -> Knots:
    """Return frequencies from `low` to `high`, in Hz, between which R/f^2 is linear within `TOLERANCE`.

    The middle of each interval is computed and kept. Where it is missed by more, both halves are looked at in
    turn. The error of what is kept is about a quarter of that stated.

    Parameters
    ----------
    resistance : callable
        From a frequency to a matrix (r, r).
    modes : (r, m) array
        Vectors whose power is compared.
    """
    count = max(int(np.ceil(np.log(high / low) / np.log(WIDEST))), 1)
    start = np.geomspace(low, high, count + 1)
    found = {float(frequency): resistance(float(frequency)) for frequency in start}
    error, pending = 0.0, list(zip(start[:-1].tolist(), start[1:].tolist(), strict=True))
    while pending:
        left, right = pending.pop()
        middle = float(np.sqrt(left * right))
        found[middle] = resistance(middle)
        missed = _missed(left, middle, right, found, modes)
        if missed > TOLERANCE and right / left > CLOSEST:
            pending += [(left, middle), (middle, right)]
        else:
            error = max(error, missed)
    frequency = np.array(sorted(found))
    return Knots(frequency, np.stack([found[float(at)] for at in frequency]), error)


def octaves(low: float, high: float) -> list[tuple[float, float]]:
    """Return ranges of at most an octave from `low` to `high`, each a bit above the one before.

    Each has its own panels: the highest are too many for the lowest.
    """
    if low >= high:
        return []
    ends = np.geomspace(low, high, max(int(np.ceil(np.log2(high / low))), 1) + 1).tolist()
    starts = [low, *(float(np.nextafter(end, np.inf)) for end in ends[1:-1])]
    return list(zip(starts, ends[1:], strict=True))


def expected_knots(ka: float) -> float:
    """Return how many frequencies `knots_between` about takes in an octave up to a wavenumber times radius.

    Counted on cast boxes with 40 and 100 coordinates, ka of 0.6 to 28: within a quarter. Few simple modes
    need half as many.
    """
    return FEWEST + KNOTS[0] * ka + KNOTS[1] * ka**2


def constant_knots(low: float, high: float, matrix: ComplexArray) -> Knots:
    """Return frequencies between which a matrix that does not change is interpolated within 0.01 dB."""
    frequency = np.geomspace(low, high, max(int(np.ceil(np.log(high / low) / np.log(CONSTANT))), 1) + 1)
    return Knots(frequency, np.broadcast_to(matrix, (frequency.size, *matrix.shape)), 4.0 * CONSTANT_ERROR)


def _missed(
    left: float, middle: float, right: float, found: dict[float, ComplexArray], modes: FloatArray
) -> float:
    """Return by how much the two ends miss the power of a mode in the middle, dB."""
    ends = ModalResistance(np.array([left, right]), np.stack([found[left], found[right]]))
    expected = ends.alone(np.array([middle]), modes)[0]
    own = np.einsum("mk,mn,nk->k", modes, found[middle], modes, optimize=True).real
    floor = NOTHING * float(own.max(initial=0.0)) or 1.0
    return float(np.max(np.abs(10.0 * np.log10((expected + floor) / (own + floor))), initial=0.0))
