"""Pressure over the unrolled flank, interpolated between the computed points."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.types import BoolArray, FloatArray
from host.loops import njit

ROWS = 96  # along the profile

_SAME = 0.01  # of the mean distance of contacts; nearer ones, as on a tip edge, count as one place


def pressure_map(flanks: LoadDistribution, roll: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return roll lengths (R,), m, and the largest pressure (R, K), Pa, that passes over a flank there.

    Along the profile the pressure is interpolated between the contacts at neighboring positions, at every
    face position by itself. Contacts on the path and those of either tip edge pass one after the other.
    `roll`: roll lengths on this flank, m.
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
            passing = np.zeros(pressure.shape)
            _pass_between(rows, roll, flanks.pressure, part, ends, passing)
            np.maximum(pressure, passing, out=pressure)
    return rows, pressure


@njit(cache=True)
def _pass_between(
    rows: FloatArray,
    roll: FloatArray,
    pressure: FloatArray,
    part: BoolArray,
    ends: tuple[float, float],
    out: FloatArray,
) -> None:
    """Interpolate the pressures (P, N, K) of a part of the contacts at `rows` into `out` (R, K).

    Of several contacts at one place the largest pressure counts. Beyond the first and the last contact of a
    slice the pressure stays constant up to the `ends` of the part, and is 0 beyond these.
    """
    for k in range(out.shape[1]):
        points = np.flatnonzero(part[:, :, k].copy().ravel())
        if points.size == 0:
            continue
        at, known = roll[:, :, k].copy().ravel()[points], pressure[:, :, k].copy().ravel()[points]
        spacing = _SAME * (ends[1] - ends[0]) / points.size
        spacing = spacing if spacing > 0.0 else 1.0
        number = np.rint((at - ends[0]) / spacing)
        order = np.argsort(number)
        knots, largest, last = np.empty(points.size), np.empty(points.size), -1
        for i in order:
            if last < 0 or number[i] != knots[last]:
                last += 1
                knots[last], largest[last] = number[i], known[i]
            largest[last] = max(largest[last], known[i])
        passing = np.interp(rows, ends[0] + spacing * knots[: last + 1], largest[: last + 1])
        reached = (rows >= ends[0]) & (rows <= ends[1])
        out[:, k] = np.where(reached, passing, 0.0)
