"""Roll lengths along both flanks of a contact, and the slopes of the material removed from them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray


def flank_slope(
    pair: ParallelAxes,
    gear: int,
    removed: Callable[[tuple[FloatArray, FloatArray]], FloatArray],
    s: tuple[FloatArray, FloatArray],
    step: FloatArray,
) -> FloatArray:
    """Return the slope of the material removed from a flank over its roll length, towards the tip.

    Towards the tip the roll length of a ring gear falls. The slope is a difference over about a contact
    strip, within the flank.

    Parameters
    ----------
    gear : int
        0 is gear 1, 1 is gear 2.
    removed : callable
        Material removed in m at roll lengths of both gears, m.
    s : (FloatArray, FloatArray)
        Flank coordinates of both gears, m.
    step : ndarray
        Half the distance of the differences along the flank, m.
    """
    toothing = (pair.pinion, pair.wheel)[gear]
    roll_1, roll_2 = rolls_at(pair, *s)
    roll, sign = (roll_1, roll_2)[gear], toothing.sign
    half = step * toothing.base_radius / roll
    middle = sign * np.minimum(sign * roll, sign * toothing.tip_form_roll_length - half)
    if gear == 0:
        rise = removed((middle + half, roll_2)) - removed((middle - half, roll_2))
    else:
        rise = removed((roll_1, middle + half)) - removed((roll_1, middle - half))
    return np.asarray(sign * rise / (2.0 * half))


def rolls_at(pair: ParallelAxes, s_1: FloatArray, s_2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the roll lengths in m at flank coordinates of both gears."""
    return (
        np.sqrt(2.0 * pair.pinion.base_radius * np.maximum(s_1, 0.0)),
        np.sqrt(2.0 * pair.wheel.base_radius * np.maximum(pair.wheel.sign * s_2, 0.0)),
    )
