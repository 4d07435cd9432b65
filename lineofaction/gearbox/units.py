"""Units at the boundary: the SI value of one unit, by the ending of the fields' names."""

from __future__ import annotations

import math
from typing import Any

from bounds import DEPTHS, Declared, Unit

MM = 1e-3
UM = 1e-6
MRAD = 1e-3
NM = 1e-9
GPA = 1e9
MPA = 1e6
DEGREE = math.pi / 180.0
G_MM = 1e-6
RPM = 2.0 * math.pi / 60.0
N_PER_UM = 1e6
N_PER_MM3 = 1e9
STANDARD_GRAVITY = 9.80665
"""Standard gravity, m/s^2 (ISO 80000-3)."""

UNITS: dict[str, Unit] = {
    "_g_mm": Unit("g mm", G_MM, "kg m"),
    "_n_per_um": Unit("N/µm", N_PER_UM, "N/m"),
    "_n_per_mm3": Unit("N/mm^3", N_PER_MM3, "N/m^3"),
    "_mm_per_s": Unit("mm/s", MM, "m/s"),
    "_mm": Unit("mm", MM, "m"),
    "_um": Unit("µm", UM, "m"),
    "_mrad": Unit("mrad", MRAD, "rad"),
    "_nm": Unit("nm", NM, "m"),
    "_gpa": Unit("GPa", GPA, "Pa"),
    "_mpa": Unit("MPa", MPA, "Pa"),
    "_deg": Unit("deg", DEGREE, "rad"),
    "_rpm": Unit("rpm", RPM, "rad/s"),
    "_kg_per_m3": Unit("kg/m^3"),
    "_kg_m2": Unit("kg m^2"),
    "_kg": Unit("kg"),
    "_n_m_per_rad": Unit("N m/rad"),
    "_n_m_s_per_rad": Unit("N m s/rad"),
    "_n_s_per_m": Unit("N s/m"),
    "_n_per_m": Unit("N/m"),
    "_n_m": Unit("N m"),
    "_n": Unit("N"),
    "_m_per_s2": Unit("m/s^2"),
    "_m2": Unit("m^2"),
    "_m": Unit("m"),
    "_hz": Unit("Hz"),
    "_s": Unit("s"),
    "_w": Unit("W"),
    "_db_a": Unit("dB(A)"),
    "_db": Unit("dB"),
    "_degc": Unit("degC"),
    "_per_k": Unit("1/K"),
    "_mib": Unit("MiB"),
    "_mb": Unit("MB"),
}
"""Unit by the ending of a name. A longer ending stands before its own shorter endings."""

BY_SUFFIX = {ending: unit for ending, unit in UNITS.items() if unit.factor != 1.0}
"""The endings of units that are not SI's."""

_OF_SI = {
    "m": "_mm",
    "rad": "_deg",
    "rad/s": "_rpm",
    "s": "_s",
    "Hz": "_hz",
    "Pa": "_gpa",
    "N": "_n",
    "N/m": "_n_per_m",
    "N/m^3": "_n_per_mm3",
    "N s/m": "_n_s_per_m",
    "N m": "_n_m",
    "N m/rad": "_n_m_per_rad",
    "N m s/rad": "_n_m_s_per_rad",
    "kg": "_kg",
    "kg m": "_g_mm",
    "kg m^2": "_kg_m2",
    "kg/m^3": "_kg_per_m3",
    "degC": "_degc",
    "1/K": "_per_k",
}
"""The ending of a declared field by its unit; depths are in um."""

ENDINGS = (*BY_SUFFIX, *_OF_SI.values(), "_n_per_m_n", "_m_per_s2", "_matrix")
"""Endings of names of fields at the boundary."""

_RENAMED = {"worth": "influence_m", "worth_relative": "relative_influence", "worths": "influences"}
"""Keys of effect ledgers in the files of runs and studies of former versions, and today's."""


def suffix_of(declaration: Declared) -> str:
    """Return the ending of a declared field's name at the boundary."""
    if declaration.written:
        return next(suffix for suffix, unit in BY_SUFFIX.items() if unit.name == declaration.written)
    return "_um" if declaration.kind in DEPTHS else _OF_SI.get(declaration.unit, "")


def ending_of(name: str) -> str:
    """Return the ending of a name that states its unit, a key of `UNITS`; empty if none does."""
    return next((ending for ending in UNITS if name.endswith(ending)), "")


def unit_of(name: str) -> Unit | None:
    """Return the unit of the boundary field `name`, or of an entry of it; None where it is SI's."""
    return BY_SUFFIX.get(ending_of(name.rpartition(".")[2].partition("[")[0]))


def unit_name(name: str) -> str | None:
    """Return the symbol of the unit of the boundary field `name`; None: the unit is SI's, or none."""
    unit = unit_of(name)
    return unit.name if unit else None


def factor(name: str) -> float:
    """Return the SI value of one unit of the boundary field `name`, 1 for a name without such a unit."""
    unit = unit_of(name)
    return unit.factor if unit else 1.0


def as_typed(value: float, unit: float = 1.0) -> float:
    """Return a value in SI in a unit, without the noise of conversions: 60 for 59.99999999999999."""
    return float(f"{value / unit:.12g}")


def boundary_ledger(ledger: Any) -> Any:
    """Return the effect ledger of a table, a plan, a run or a study with its lengths in um.

    Libraries and files have them in m, as ``influence_m`` and ``mean_m``.
    """
    return in_um(_renamed(ledger))


def _renamed(plain: Any) -> Any:
    if isinstance(plain, list):
        return [_renamed(entry) for entry in plain]
    if not isinstance(plain, dict):
        return plain
    return {_RENAMED.get(name, name): _renamed(entry) for name, entry in plain.items()}


def in_um(plain: Any, *, is_length: bool = False) -> Any:
    """Turn every field of plain JSON that ends in _m (and no torque) into one that ends in _um.

    `is_length`: the value is of such a field.
    """
    if isinstance(plain, list):
        return [in_um(entry, is_length=is_length) for entry in plain]
    if not isinstance(plain, dict):
        return plain / UM if is_length and plain is not None else plain
    lengths = {name for name in plain if name.endswith("_m") and not name.endswith("_n_m")}
    return {
        f"{name.removesuffix('_m')}_um" if name in lengths else name: in_um(entry, is_length=name in lengths)
        for name, entry in plain.items()
    }
