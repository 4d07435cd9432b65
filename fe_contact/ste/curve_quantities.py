"""Mean, peak-to-peak and mesh harmonics of transmission-error curves, and the differences of these.

A curve covers `period` base pitches; its orders are multiples of the frequency of the period, of which each
`period`-th is a mesh harmonic. Orders off the mesh arise where pitches differ. Shapes: P or Q positions, C
curves, 23 quantities (`QUANTITIES`): mean, peak-to-peak, the largest order off the mesh, 20 mesh harmonics.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import ComplexArray, FloatArray

HARMONICS = 20
MEAN, PEAK_TO_PEAK, OFF_MESH, FIRST_HARMONIC = range(4)
"""Indices of the quantities of a curve: mean, peak-to-peak, the largest order that is no mesh order, and the
first harmonic, which the others follow.

Deviations that repeat at every pitch are in mesh orders alone. Other orders have the error of the differences
between pitches.
"""
QUANTITIES = FIRST_HARMONIC + HARMONICS
BY_SOURCE = {"mean_m": MEAN, "peak_to_peak_m": PEAK_TO_PEAK, "first_harmonic_m": FIRST_HARMONIC}
"""Index of each quantity whose errors a receipt has by source, by its key; m."""
_PER_PITCH, _PER_PERIOD, _FEWEST = 256, 2**15, 64
"""Samples of a base pitch, a dozen for the shortest harmonic; most samples of a period; least of a base pitch
in a long period, which comes first.
"""
_FEWEST_ROWS = 8
"""Least positions with a solution for which a curve has quantities."""


class Quantities(NamedTuple):
    """Peak-to-peak (C,) of curves; mean and phasors (20 period + 1, C) of all orders, 1/period apart."""

    ripple: FloatArray
    lines: ComplexArray
    period: int


def quantity_changes(
    position: FloatArray, curves: FloatArray, other: FloatArray, period: int, at: FloatArray | None = None
) -> FloatArray:
    """Return by how much the quantities of two sets of curves differ, (23, C) in m.

    The difference of a harmonic is the length of the difference of the two phasors, which bounds the change
    of its amplitude and does not vanish where only the phase moves. The difference of peak-to-peak, where the
    knots are the same, is at least half the peak-to-peak of the difference of the curves, since it may cross
    zero by accident.

    Parameters
    ----------
    position : ndarray, shape (P,)
        Knots of `curves` in base pitches, increasing in [0, period).
    curves, other : ndarray, shapes (P, C), (Q, C)
        STE in m; NaN where a solution failed. Such a row is left out of the curves it belongs to.
    period : int
        Base pitches.
    at : ndarray, shape (Q,), optional
        Knots of `other`; default: those of `curves`.

    Returns
    -------
    ndarray
        NaN for curves with fewer than eight positions with a solution. The entry of orders off the mesh is
        the difference of the order that changes most.
    """
    knots = position if at is None else at
    good = np.isfinite(curves) if at is not None else np.isfinite(curves) & np.isfinite(other)
    finite = np.isfinite(other) if at is not None else good
    if good.all() and finite.all():
        if at is not None:
            return _changes(_quantities(position, curves, period), _quantities(knots, other, period))
        ripple, lines, _ = _quantities(position, np.concatenate([curves, other], axis=1), period)
        parts = zip(np.split(ripple, 2), np.split(lines, 2, axis=1), strict=True)
        return _with_bend(_changes(*(Quantities(*part, period) for part in parts)), curves - other)
    changes = np.full((QUANTITIES, curves.shape[1]), np.nan)
    for c in range(curves.shape[1]):
        rows, others = good[:, c], finite[:, c]
        if min(rows.sum(), others.sum()) >= _FEWEST_ROWS:
            first = _quantities(position[rows], curves[rows, c : c + 1], period)
            second = _quantities(knots[others], other[others, c : c + 1], period)
            changes[:, c] = _changes(first, second)[:, 0]
            if at is None:
                changes[:, c : c + 1] = _with_bend(changes[:, c : c + 1], (curves - other)[rows, c : c + 1])
    return changes


def quantity_derivatives(values: FloatArray, period: int) -> FloatArray:
    """Return the derivatives of the quantities of a curve by its values, (23, P).

    Those of a harmonic are of its amplitude, those of peak-to-peak are 1 at the highest and -1 at the lowest
    value. The row of orders off the mesh is 0.

    Parameters
    ----------
    values : ndarray, shape (P,)
        STE in m at equally spaced positions over the period.
    period : int
        Base pitches. 41 values in each resolve all harmonics; those that are not resolved have NaN.
    """
    position, order = np.arange(values.size) * (period / values.size), np.arange(1, HARMONICS + 1)
    waves = np.exp(-2.0j * np.pi * order[:, None] * position) * (2.0 / values.size)
    waves[2 * order * period >= values.size] = np.nan
    lines = waves @ values
    ripple = np.zeros(values.size)
    ripple[np.argmax(values)] += 1.0
    ripple[np.argmin(values)] -= 1.0
    amplitude = np.abs(lines)
    turned = np.divide(lines.conj(), amplitude, out=np.ones_like(lines), where=amplitude > 0.0)
    mean = np.full(values.size, 1.0 / values.size)
    return np.stack([mean, ripple, np.zeros(values.size), *(turned[:, None] * waves).real])


def _with_bend(changes: FloatArray, difference: FloatArray) -> FloatArray:
    """Return changes, that of peak-to-peak at least half the peak-to-peak of `difference` (P, C)."""
    minimum = 0.5 * np.ptp(difference, axis=0)
    return np.concatenate([changes[:1], np.maximum(changes[1:2], minimum), changes[2:]])


def peak_excess(position: FloatArray, values: FloatArray, period: int) -> FloatArray:
    """Return by how much corners between the knots may stand out of the range of curves (P, C), (C,) in m.

    A corner is where the chords before and after an interval meet inside it; tops and bottoms are added.
    """
    step = Axis(position, float(period)).spacing[:, None]
    return _crest_excess(step, values) + _crest_excess(step, -values)


def _crest_excess(step: FloatArray, values: FloatArray) -> FloatArray:
    """Return the height of the highest corner above the highest knot, >= 0, (C,) in m."""
    following = np.roll(values, -1, axis=0)
    chord = (following - values) / step
    before, after = np.roll(chord, 1, axis=0), np.roll(chord, -1, axis=0)
    peaked = (before > 0.0) & (after < 0.0)
    turn = np.where(peaked, before - after, 1.0)
    where = np.clip((following - values - after * step) / turn, 0.0, step)
    tops = np.where(peaked, values + before * where, -np.inf)
    return np.asarray(np.maximum(tops.max(axis=0) - values.max(axis=0), 0.0))


def error_bound(position: FloatArray, band: FloatArray, values: FloatArray, period: int) -> FloatArray:
    """Return the largest errors (23, C), m, of the quantities of curves (P, C) with errors in a band (P, C).

    The error of the mean is the mean of the band, that of peak-to-peak the sum of the band at both extremes,
    and that of any order twice the mean of the band.
    """
    mean = mean_of_curves(position, np.nan_to_num(band), period)
    known = np.nan_to_num(values)
    ends = [np.take_along_axis(band, pick(known, axis=0)[None], 0)[0] for pick in (np.argmax, np.argmin)]
    return np.stack([mean, np.nan_to_num(ends[0] + ends[1]), *[2.0 * mean] * (QUANTITIES - OFF_MESH)])


def mean_of_curves(position: FloatArray, values: FloatArray, period: int) -> FloatArray:
    """Return the mean (...) of curves (P, ...) that are straight between their knots."""
    spacing = Axis(position, float(period)).spacing
    weight = 0.5 * (spacing + np.roll(spacing, 1)) / period
    return np.asarray(np.tensordot(weight, values, 1))


def _quantities(position: FloatArray, values: FloatArray, period: int) -> Quantities:
    """Return peak-to-peak of the knots, and mean and phasors of the interpolant."""
    per_pitch = max(min(_PER_PITCH, _PER_PERIOD // period), _FEWEST)
    even = np.arange(period * per_pitch) / per_pitch
    samples = interpolate(Axis(position, float(period)), values, even)
    lines = np.fft.rfft(samples, axis=0)[: HARMONICS * period + 1] * (2.0 / even.size)
    lines[0] *= 0.5
    return Quantities(np.asarray(np.ptp(values, axis=0)), lines, period)


def _changes(quantities: Quantities, other: Quantities) -> FloatArray:
    """Return the differences of two sets of quantities, (23, C)."""
    lines, ripple = np.abs(quantities.lines - other.lines), np.abs(quantities.ripple - other.ripple)
    mesh = lines[:: quantities.period].copy()
    lines[:: quantities.period] = 0.0
    return np.concatenate([mesh[:1], ripple[None], lines.max(axis=0)[None], mesh[1:]])
