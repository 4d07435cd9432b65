"""Units in which a number may have been typed by mistake."""

from __future__ import annotations

import math

from bounds.unit import Unit

TYPED: dict[str, tuple[Unit, ...]] = {
    "m": (Unit("meters", 1.0), Unit("millimeters", 1e-3), Unit("micrometers", 1e-6), Unit("inches", 25.4e-3)),
    "N m": (Unit("kN m", 1e3), Unit("N mm", 1e-3), Unit("N m", 1.0)),
    "N": (Unit("kN", 1e3), Unit("N", 1.0)),
    "rad": (Unit("radians", 1.0), Unit("degrees", math.pi / 180.0)),
    "Pa": (Unit("GPa", 1e9), Unit("MPa", 1e6), Unit("Pa", 1.0)),
    "N/m": (Unit("N/um", 1e6), Unit("N/mm", 1e3), Unit("N/m", 1.0)),
    "rad/s": (Unit("rad/s", 1.0), Unit("rpm", math.pi / 30.0), Unit("degrees per second", math.pi / 180.0)),
    "s": (Unit("milliseconds", 1e-3), Unit("seconds", 1.0)),
    "kg": (Unit("grams", 1e-3), Unit("kilograms", 1.0)),
    "kg/m^3": (Unit("g/cm^3", 1e3), Unit("kg/m^3", 1.0)),
    "kg m^2": (Unit("kg cm^2", 1e-4), Unit("kg mm^2", 1e-6), Unit("kg m^2", 1.0)),
    "1": (Unit("per cent", 1e-2),),
}
"""By SI unit: what people type instead, the likeliest first."""

SI_UNITS = {name: Unit(name, 1.0) for name in TYPED}


def suspected_unit(value: float, own: Unit, dimension: str, low: float, high: float) -> str:
    """Return the unit in which a number makes sense that does not in its own; empty where there is none.

    Parameters
    ----------
    value : float
        In SI, as read in the unit `own`.
    own : Unit
        Of the field.
    dimension : str
        SI unit of the quantity, e.g. "m".
    low, high : float
        Usual magnitudes in SI.
    """
    typed = abs(value) / own.factor
    for unit in TYPED.get(dimension, ()):
        if typed and not math.isclose(unit.factor, own.factor) and low <= typed * unit.factor <= high:
            return unit.name
    return ""
