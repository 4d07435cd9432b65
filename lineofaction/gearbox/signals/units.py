"""Units of measured channels: their SI values, by the unit of a file or the ending of a name."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import STANDARD_GRAVITY

_TURN = 2.0 * math.pi
ACCELERATION = "acceleration"
VELOCITY = "velocity"
FORCE = "force"
LENGTH = "displacement"
SPEED = "speed"
TORQUE = "torque"
TIME = "time"
ANGLE = "angle"
_SPELLINGS: dict[tuple[str, float], tuple[str, ...]] = {
    (ACCELERATION, 1.0): ("m/s²", "m/s2", "m/s^2", "m/s**2", "m s-2", "ms-2", "m s^-2"),
    (ACCELERATION, 1e-3): ("mm/s²", "mm/s2", "mm/s^2"),
    (ACCELERATION, STANDARD_GRAVITY): ("g", "gn", "g_n"),
    (VELOCITY, 1.0): ("m/s", "m s-1"),
    (VELOCITY, 1e-3): ("mm/s",),
    (FORCE, 1.0): ("n", "newton"),
    (FORCE, 1e3): ("kn",),
    (LENGTH, 1.0): ("m",),
    (LENGTH, 1e-3): ("mm",),
    (LENGTH, 1e-6): ("µm", "um", "μm"),
    (SPEED, 1.0): ("rad/s", "rad s-1"),
    (SPEED, _TURN / 60.0): ("rpm", "1/min", "min-1", "min^-1", "r/min", "rev/min", "u/min"),
    (SPEED, _TURN): ("hz", "1/s", "rev/s", "r/s"),
    (SPEED, math.pi / 180.0): ("deg/s", "°/s"),
    (TORQUE, 1.0): ("n m", "nm", "n*m", "n·m", "newton meter"),
    (TORQUE, 1e3): ("kn m", "knm"),
    (TIME, 1.0): ("s", "sec", "seconds"),
    (TIME, 1e-3): ("ms",),
    (ANGLE, 1.0): ("rad",),
    (ANGLE, math.pi / 180.0): ("deg", "°"),
}
_ENDINGS = {
    "_m_per_s2": "m/s²",
    "_g": "g",
    "_n_m": "N m",
    "_kn": "kN",
    "_n": "N",
    "_um": "µm",
    "_mm": "mm",
    "_rpm": "rpm",
    "_rad_per_s": "rad/s",
    "_hz": "Hz",
    "_ms": "ms",
    "_s": "s",
    "_deg": "deg",
}
"""Unit by the ending of a name, as at the rest of the boundary; longer endings stand before their ends."""


@dataclass(frozen=True)
class MeasuredUnit:
    """A unit of a channel: the quantity that it measures, and its value in the SI unit."""

    quantity: str
    factor: float


_BY_SPELLING = {
    spelling: MeasuredUnit(quantity, factor)
    for (quantity, factor), spellings in _SPELLINGS.items()
    for spelling in spellings
}


def unit_of_name(name: str) -> str:
    """Return the unit that the ending of a name states, as of `acceleration_m_per_s2`; empty if none."""
    return next((unit for ending, unit in _ENDINGS.items() if name.lower().endswith(ending)), "")


def measured_unit(text: str) -> MeasuredUnit | None:
    """Return the unit of a spelling; None of one that is not known."""
    return _BY_SPELLING.get(" ".join(text.split()).lower())


def required_unit(field: str, text: str, quantity: str) -> MeasuredUnit:
    """Return the unit of a channel that measures a quantity.

    Raises `BadInput`: there is none, it is not known, or it measures something else.
    """
    unit = measured_unit(text)
    if unit is None or unit.quantity != quantity:
        known = dict.fromkeys(spellings[0] for (kind, _), spellings in _SPELLINGS.items() if kind == quantity)
        remedy = f"State the unit of {quantity}: {', '.join(known)}."
        raise BadInput.of(field, text or None, f"a unit of {quantity}", remedy)
    return unit
