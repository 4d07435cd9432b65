"""Sliding of the flanks along the path of contact (ISO 21771-1, clause 5.6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.types import FloatArray


def sliding_factor(pair: ParallelAxes, roll_length: ArrayLike) -> FloatArray:
    """Return K_g = v_g / v_t, sliding velocity over pitch-line velocity, at `roll_length` of gear 1 in m.

    It is 0 at the pitch point and > 0 beyond it, where the driving flank is the faster one. With the distance
    y from the pitch point v_g is (omega_1 + omega_2) y, of an internal pair (omega_1 - omega_2) y.
    """
    first = np.asarray(roll_length, dtype=float)
    second = pair.mating_roll_length(first)
    return np.asarray((first - second / pair.speed_ratio) / pair.operating_pitch_radii[0], dtype=float)


def specific_sliding(pair: ParallelAxes, roll_length: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return zeta_1, zeta_2: sliding over each flank's own velocity, at `roll_length` of gear 1 in m.

    The flanks roll at v_1 = omega_1 l_1 and v_2 = omega_2 l_2; zeta_1 = (v_1 - v_2) / v_1 and
    zeta_2 = (v_2 - v_1) / v_2: at most 1, and most negative near the root. -inf at a base circle.
    """
    first = np.asarray(roll_length, dtype=float)
    second = pair.mating_roll_length(first)
    with np.errstate(divide="ignore"):
        ratio = np.divide(second, pair.speed_ratio * first)
        return np.asarray(1.0 - ratio), np.asarray(1.0 - 1.0 / ratio)
