"""Laws by which a relief grows from nothing where it starts to its amount (ISO 21771-1, clause 7).

REXS names the shapes. An arc touches the involute where it starts; flank reliefs are some 1e-2 of their
length deep, so that it is the parabola to 1e-4 of the amount. Exponential is (e^u - 1) / (e - 1), logarithmic
ln(1 + (e - 1) u): the laws of these names without a further parameter.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.problems import BadInput

Law = Callable[[FloatArray], FloatArray]
"""Relative depth over the fraction of the length; 0 up to 0, 1 at 1."""
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


def shape_of(part: Part, item: str = "shape_of_relief") -> str:
    """Return the shape of a relief or crowning, linear by default.

    Raises
    ------
    BadInput
        REXS has no such shape.
    """
    word = part.text(item, "shape")
    if word is None:
        part.say(item, "defaulted", "linear")
        return "linear"
    if word not in LAWS:
        raise BadInput.of(f"{part.place}, {item}", word, f"one of {', '.join(LAWS)}")
    return word


def relative_depth(shape: str, fraction: FloatArray) -> FloatArray:
    """Return the depth of a relief by that at its end, at fractions of its length; 0 before it starts."""
    return np.asarray(LAWS[shape](np.maximum(fraction, 0.0)))


def blended_depth(fraction: FloatArray, start: float, end: float) -> FloatArray:
    """Return the depth of a linear relief whose slope grows evenly between two fractions.

    1 at the fraction 1; tangential to the involute at `start`, straight from `end` on.
    """
    inside = np.clip(fraction, start, end)
    rise = 0.5 * (inside - start) ** 2 / (end - start) + np.maximum(fraction - end, 0.0)
    return np.asarray(rise / (1.0 - 0.5 * (start + end)))
