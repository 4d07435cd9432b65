"""The lines of a long common period that a response is solved in: the strongest of every mesh order.

Over a hunting cycle of 1 541 base pitches ten mesh orders are 15 410 lines. Lines of the mesh, of both shafts
and their sidebands are some 90 per order; the lines between them are products of small ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bounds import MAX_BYTES
from dynamics.errors import InputError
from dynamics.linearize.load_harmonics import load_multiples
from dynamics.linearize.steady_vibration import Excited, flank_forces
from dynamics.types import BoolArray, FloatArray, IntArray, Json

ALWAYS = 500
"""Lines that every response has; periods with no more of them are solved in all."""
MAX_AMPLITUDES = 6e6
"""Amplitudes of speeds, lines and freedoms that a response may have beyond them: 0.1 GB."""


class Lines(NamedTuple):
    """Lines in which a response is solved, and those that it leaves out."""

    harmonics: IntArray
    """Multiples of the common period's frequency, rising. Shape (H,)."""
    omitted: IntArray
    """Other excited multiples, rising. Shape (L,)."""
    share: float = 0.0
    """Root of the sum of squares of the forces in the lines left out, over that of all lines, for the mesh
    order and the row of the flanks with the largest ratio. Between the lines that count stands a floor of
    many weak ones.
    """

    def to_json(self, in_totals: bool) -> Json:
        """Return the facts on lines left out, and whether totals have them; empty without such lines."""
        if not self.omitted.size:
            return {}
        return {"lines_left_out": {"count": self.omitted.size, "force": self.share, "in_totals": in_totals}}


def strongest_lines(at: Excited, harmonics: IntArray, speed: FloatArray) -> Lines:
    """Return which of `harmonics` (H,) count: as many as can be held, the strongest of every mesh order.

    A line is as strong as the largest force that it excites along a row of the flanks, of the largest of that
    row in its mesh order. Orders of the meshes and of the loads at the highest `speed` (S,), rad/s, always
    count.
    """
    maximum = max(ALWAYS, int(MAX_AMPLITUDES / max(speed.size * at.system.arrays.mass.shape[0], 1)))
    if harmonics.size <= maximum:
        return Lines(harmonics, harmonics[:0])
    _, exciting = flank_forces(at, harmonics)
    force = np.abs(exciting)
    bands, band = np.unique(np.rint(harmonics / at.period.counted), return_inverse=True)
    size = np.zeros(harmonics.size)
    for index in range(bands.size):
        inside = band == index
        size[inside] = np.max(
            _share(force[:, inside], np.max(force[:, inside], axis=1, keepdims=True)), axis=0
        )
    size[_always(at, harmonics, float(np.max(np.abs(speed))))] = np.inf
    chosen = _of_every_band(size, band, maximum)
    squares = np.square(force)
    parts = [
        (squares[:, inside & ~chosen], squares[:, inside])
        for inside in (band == k for k in range(bands.size))
    ]
    left = [np.sqrt(np.max(_share(*(part.sum(axis=1) for part in pair)))) for pair in parts]
    return Lines(harmonics[chosen], harmonics[~chosen & np.any(force, axis=0)], float(max(left)))


def require_memory(speeds: int, lines: int, numbers: int, freedoms: int) -> None:
    """Refuse more speeds than memory holds with `numbers` complex numbers for each speed and line.

    Raises `InputError`: there are too many.
    """
    maximum = int(MAX_BYTES // (16 * numbers * max(lines, 1)))
    if speeds > maximum:
        memory = f"as {MAX_BYTES / 1e9:g} GB hold"
        bound = f"at most {maximum} values in {lines} orders of {freedoms} freedoms, {memory}"
        raise InputError("speed", f"{speeds} values", bound, "Take wider steps, or fewer orders.")


def _share(part: FloatArray, total: FloatArray) -> FloatArray:
    """Return a part of a whole; of nothing 0."""
    return np.divide(part, total, out=np.zeros_like(part), where=total > 0.0)


def _always(at: Excited, harmonics: IntArray, speed: float) -> IntArray:
    """Return the indices of the mesh orders and of the orders of loads."""
    always = np.isin(harmonics, load_multiples(at.system, at.period, speed, at.time))
    for pitches in at.period.pitches:
        if pitches:
            always |= harmonics % abs(pitches) == 0
    return np.flatnonzero(always)


def _of_every_band(size: FloatArray, band: IntArray, maximum: int) -> BoolArray:
    """Return whether each line is among the `maximum` strongest, of every band as many."""
    maximum = max(maximum // np.unique(band).size, 1)
    order = np.lexsort((-size, band))
    first = np.searchsorted(band[order], band[order], side="left")
    chosen = np.zeros(size.size, dtype=bool)
    chosen[order] = (np.arange(size.size) - first < maximum) | np.isinf(size[order])
    return chosen
