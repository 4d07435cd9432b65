"""Laws of time laid out for the compiled loops."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.arrays.arrays import LawArrays
from dynamics.loads import AngleLaw, TimeLaw
from dynamics.types import FloatArray


def pack_laws(laws: Sequence[TimeLaw | AngleLaw]) -> LawArrays:
    """Lay out `laws` one after the other."""
    parts = [law.polynomials() for law in laws]
    first = np.cumsum([0, *(start.size for start, _ in parts)], dtype=np.int64)
    start = np.concatenate([np.empty(0), *(start for start, _ in parts)])
    coefficient = np.concatenate([np.empty((0, 4)), *(values for _, values in parts)])
    return LawArrays(first, start, np.ascontiguousarray(coefficient))


def slope(law: TimeLaw | AngleLaw, moment: FloatArray) -> FloatArray:
    """Return the derivative of `law` at `moment` (s), from the right where it jumps."""
    start, coefficient = law.polynomials()
    piece = np.searchsorted(start[1:], moment, side="right")
    elapsed, c = moment - start[piece], coefficient[piece]
    return np.asarray(c[..., 1] + elapsed * (2.0 * c[..., 2] + 3.0 * elapsed * c[..., 3]), dtype=float)


def revolutions(law: TimeLaw | AngleLaw) -> tuple[FloatArray, FloatArray]:
    """Return whole and fractional revolutions at the start of each piece of a speed law; 0 at t = 0."""
    start, coefficient = law.polynomials()
    span = np.diff(start)
    turned = np.concatenate([[0.0], np.cumsum(_integral(coefficient[:-1], span))])
    piece = int(np.searchsorted(start[1:], 0.0, side="right"))
    origin = turned[piece] + _integral(coefficient[piece], np.array(-start[piece]))
    turns = (turned - origin) / (2.0 * math.pi)
    return np.floor(turns), turns - np.floor(turns)


def _integral(c: FloatArray, s: FloatArray) -> FloatArray:
    """Integral of cubics from 0 to s."""
    value = s * (c[..., 0] + s * (c[..., 1] / 2.0 + s * (c[..., 2] / 3.0 + s * c[..., 3] / 4.0)))
    return np.asarray(value, dtype=float)
