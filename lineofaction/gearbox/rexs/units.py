"""The units of REXS in SI."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lineofaction.gearbox.rexs.refusal import refused


@dataclass(frozen=True)
class SiUnit:
    """A unit: a value v in it is v * factor + offset in the SI unit `si`."""

    si: str
    factor: float = 1.0
    offset: float = 0.0


_TURN = 2.0 * math.pi
_DEGREE = SiUnit("rad", math.pi / 180.0)
_NONE = SiUnit("")

UNITS: dict[str, SiUnit] = {
    "none": _NONE,
    "": _NONE,
    "%": SiUnit("", 1e-2),
    "dB": SiUnit("dB"),
    "HB": SiUnit("HB"),
    "HRC": SiUnit("HRC"),
    "HV": SiUnit("HV"),
    "MRev": SiUnit("rad", 1e6 * _TURN),
    # lengths, angles, time
    "mm": SiUnit("m", 1e-3),
    "mum": SiUnit("m", 1e-6),
    "1 / mm": SiUnit("1/m", 1e3),
    "mm^2": SiUnit("m^2", 1e-6),
    "m^2": SiUnit("m^2"),
    "deg": _DEGREE,
    "°": _DEGREE,
    "rad": SiUnit("rad"),
    "s": SiUnit("s"),
    "mus": SiUnit("s", 1e-6),
    "h": SiUnit("s", 3600.0),
    "Hz": SiUnit("1/s"),
    "1 / s": SiUnit("1/s"),
    "1 / min": SiUnit("rad/s", _TURN / 60.0),
    "rad / s": SiUnit("rad/s"),
    "m / s": SiUnit("m/s"),
    "mm / h": SiUnit("m/s", 1e-3 / 3600.0),
    "m / s^2": SiUnit("m/s^2"),
    "l / min": SiUnit("m^3/s", 1e-3 / 60.0),
    "m^3 / s": SiUnit("m^3/s"),
    # masses
    "kg": SiUnit("kg"),
    "mg": SiUnit("kg", 1e-6),
    "kg m^2": SiUnit("kg m^2"),
    "kg / mm": SiUnit("kg/m", 1e3),
    "kg / dm^3": SiUnit("kg/m^3", 1e3),
    # forces, stresses, stiffness
    "N": SiUnit("N"),
    "kN": SiUnit("N", 1e3),
    "N m": SiUnit("N m"),
    "N / m": SiUnit("N/m"),
    "N / mm": SiUnit("N/m", 1e3),
    "N / rad": SiUnit("N/rad"),
    "N mm / rad": SiUnit("N m/rad", 1e-3),
    "N / (mm mum)": SiUnit("N/m/m", 1e9),
    "Pa": SiUnit("Pa"),
    "MPa": SiUnit("Pa", 1e6),
    "N / mm^2": SiUnit("Pa", 1e6),
    "(N / mm^2)^0.5": SiUnit("Pa^0.5", 1e3),
    "mm^2 / N": SiUnit("1/Pa", 1e-6),
    "1e-6 mm^3 / (N m)": SiUnit("1/Pa", 1e-15),
    "mPa s": SiUnit("Pa s", 1e-3),
    "mm^2 / s": SiUnit("m^2/s", 1e-6),
    # heat and power
    "C": SiUnit("K", 1.0, 273.15),
    "K": SiUnit("K"),
    "K / mus": SiUnit("K/s", 1e6),
    "1e-6 / C": SiUnit("1/K", 1e-6),
    "W": SiUnit("W"),
    "kW": SiUnit("W", 1e3),
    "W / mm": SiUnit("W/m", 1e3),
    "W / (m K)": SiUnit("W/(m K)"),
    "W / (m^2 K)": SiUnit("W/(m^2 K)"),
    "J / (kg K)": SiUnit("J/(kg K)"),
    "K m^2 / W": SiUnit("K m^2/W"),
    "K (m / s)^0.75 mm^1.75 / W": SiUnit("K (m/s)^0.75 m^1.75/W", 1e-3**1.75),
    "N / (mm s^0.5 K)": SiUnit("N/(m s^0.5 K)", 1e3),
    # electricity
    "V": SiUnit("V"),
    "V / m": SiUnit("V/m"),
    "Ohm": SiUnit("Ohm"),
    "pF": SiUnit("F", 1e-12),
    "pS / m": SiUnit("S/m", 1e-12),
}
"""Every unit of REXS 1.0 to 2.0.0. A turn is 2 pi rad. Each hardness is a quantity of its own. Stiffness
per face width (N/m/m) is no pressure."""


def same_in_si(first: str, second: str) -> bool:
    """Return whether two units of REXS are spellings of one."""
    return UNITS[first] == UNITS[second]


def si_value(value: float, unit: str | None, expected: str, place: str) -> float:
    """Return a value in SI.

    Parameters
    ----------
    value, unit : float, str or None
        As the file has them.
    expected : str
        A unit of the value's quantity, as the schema has it.
    place : str
        Component and attribute, for the error.

    Raises
    ------
    BadInput
        The unit is none of REXS, or of another quantity.
    """
    written = UNITS.get("none" if unit is None else unit)
    wanted = UNITS[expected]
    if written is None or written.si != wanted.si:
        fit = ", ".join(name for name, own in UNITS.items() if own.si == wanted.si and name)
        raise refused(f"{place}, unit", unit, f"one of {fit}")
    return value * written.factor + written.offset
