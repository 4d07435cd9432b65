"""Units at the boundary: what one of each is in SI."""

from __future__ import annotations

import math

MM = 1e-3
UM = 1e-6
MRAD = 1e-3
NM = 1e-9
GPA = 1e9
DEGREE = math.pi / 180.0
RPM = 2.0 * math.pi / 60.0
N_PER_UM = 1e6
N_PER_MM3 = 1e9

BY_SUFFIX: dict[str, float] = {
    "_mm": MM,
    "_n_per_um": N_PER_UM,
    "_n_per_mm3": N_PER_MM3,
    "_um": UM,
    "_mrad": MRAD,
    "_nm": NM,
    "_gpa": GPA,
    "_deg": DEGREE,
    "_rpm": RPM,
}


NAMES: dict[str, str] = {
    "_mm": "mm",
    "_n_per_um": "N/um",
    "_n_per_mm3": "N/mm^3",
    "_um": "um",
    "_mrad": "mrad",
    "_nm": "nm",
    "_gpa": "GPa",
    "_deg": "deg",
    "_rpm": "rpm",
}
"""How the units of `BY_SUFFIX` are written."""


def unit_name(name: str) -> str | None:
    """Return how the unit of the boundary field `name` is written; None where it is SI's or none."""
    return next((unit for suffix, unit in NAMES.items() if name.endswith(suffix)), None)


def factor(name: str) -> float:
    """Return the SI value of one unit of the boundary field `name`, 1 for a name without such a unit."""
    return next((value for suffix, value in BY_SUFFIX.items() if name.endswith(suffix)), 1.0)


def boundary_text(value: float) -> str:
    """Return a number as users write it."""
    return f"{value:.7g}"
