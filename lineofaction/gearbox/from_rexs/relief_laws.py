"""Laws by which a relief grows from nothing at its start to its amount (ISO 21771-1, clause 7)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Part

Law = Callable[[FloatArray], FloatArray]
"""Function from the fraction of a relief's length to the fraction of its depth; 0 up to 0, 1 at 1."""

_GROWTH = math.e - 1.0

LAWS: dict[str, Law] = {
    "linear": lambda u: u,
    "parabolic": lambda u: u**2,
    "circular": lambda u: u**2,
    "exponential": lambda u: np.expm1(u) / _GROWTH,
    "logarithmic": lambda u: np.log1p(_GROWTH * u),
}

SCALABLE = ("linear", "parabolic", "circular")
"""Shapes that stay the same where the amount is stated at another place than the relief's end."""


def shape_of(part: Part) -> str:
    """Return the law of a relief by its name, linear where the file gives none."""
    item = "shape_of_relief"
    word = part.text(item, "shape")
    if word is None:
        part.say(item, "defaulted", "linear")
        return "linear"
    if word not in LAWS:
        raise part.refusal(item, word, f"one of {', '.join(LAWS)}")
    return word


def blended_depth(fraction: FloatArray, start: float, end: float) -> FloatArray:
    """Return the depth of a linear relief whose slope grows evenly between two fractions.

    The depth is 1 at the fraction 1. The relief is tangential to the involute at `start` and straight from
    `end` on.
    """
    inside = np.clip(fraction, start, end)
    rise = 0.5 * (inside - start) ** 2 / (end - start) + np.maximum(fraction - end, 0.0)
    return np.asarray(rise / (1.0 - 0.5 * (start + end)))


def two_parabolas(
    coordinate: FloatArray, highest: float, ends: tuple[float, ...], amounts: tuple[float, ...]
) -> FloatArray:
    """Return the depths (m) of two half parabolas that touch at the highest point, at places (m).

    `ends` are the places on either side where the amounts are stated.
    """
    depth = np.zeros_like(coordinate)
    for end, amount in zip(ends, amounts, strict=True):
        on_side = (coordinate - highest) * (end - highest) > 0.0
        parabola = ((coordinate - highest) / (end - highest)) ** 2
        depth = depth + amount * np.where(on_side, parabola, 0.0)
    return np.asarray(depth)
