"""Datasets of universal files: 58 (function at a nodal degree of freedom), 164 (units), 2411 (nodes)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from dynamics.types import FloatArray

DOUBLE = 4  # ordinates are real, double precision
EVEN = 1  # abscissa by its first value and its increment
SPECTRUM = "amplitude (peak), Hann window"


class FunctionType(IntEnum):
    """Kinds of function of dataset 58."""

    TIME_RESPONSE = 1
    SPECTRUM = 12
    ORDER = 24


@dataclass(frozen=True)
class Quantity:
    """An axis of dataset 58."""

    code: int
    """Specific data type: 8 displacement, 9 reaction force, 12 acceleration, 17 time, 18 frequency, 19
    revolutions per minute, 20 order.
    """
    length: int
    force: int
    """`length`, `force`: Exponents of the units of length and force."""
    label: str
    unit: str
    """`label`, `unit`: Names of the quantity and its unit, at most 20 characters each."""

    @property
    def record(self) -> str:
        """The axis in the file."""
        names = f"{self.label[:20]:<20} {self.unit[:20]:<20}"
        return f"{self.code:10d}{self.length:5d}{self.force:5d}{0:5d} {names}"


NO_AXIS = Quantity(0, 0, 0, "NONE", "NONE")
"""An axis that a function does not have."""


@dataclass(frozen=True)
class NodalFunction:
    """A function for dataset 58."""

    kind: FunctionType
    lines: tuple[str, ...]
    """Up to five lines of text."""
    entity: str
    """Name of the response, at most 10 characters."""
    node: int
    direction: int
    """`node`, `direction`: Node and direction of the response: 1, 2, 3 for x, y, z; 4, 5, 6 for rotation
    about them; 0 scalar.
    """
    abscissa: Quantity
    ordinate: Quantity
    first: float
    increment: float
    """`first`, `increment`: First value and step of the abscissa; the file keeps six digits."""
    values: FloatArray
    """Values of the ordinate. Shape (N,)."""


def units_dataset() -> str:
    """Return dataset 164: the units of the file, SI."""
    factors = "".join(f"{value:25.16E}" for value in (1.0, 1.0, 1.0)).replace("E", "D")
    offset = f"{273.15:25.16E}".replace("E", "D")
    return _dataset(164, [f"{1:10d}{'SI: Meter (newton)':<20}{2:10d}", factors, offset])


def nodes_dataset(nodes: Iterable[tuple[int, FloatArray]]) -> str:
    """Return dataset 2411: labels and positions (3,) in m, in the fixed frame."""
    records = []
    for label, origin in nodes:
        # label, coordinate systems of position and of displacement (1: the global one), color
        records.append(f"{label:10d}{1:10d}{1:10d}{11:10d}")
        records.append("".join(f"{value:25.16E}" for value in origin).replace("E", "D"))
    return _dataset(2411, records)


def function_dataset(function: NodalFunction) -> str:
    """Return dataset 58: a function at a nodal degree of freedom."""
    lines = [line[:80] for line in (*function.lines, *["NONE"] * 5)][:5]
    entity = f"{function.entity[:10]:<10}"
    node = f" {entity}{function.node:10d}{function.direction:4d} {'NONE':<10}{0:10d}{0:4d}"
    form = f"{DOUBLE:10d}{function.values.size:10d}{EVEN:10d}"
    axes = [axis.record for axis in (function.abscissa, function.ordinate, NO_AXIS, NO_AXIS)]
    return _dataset(
        58,
        [
            *lines,
            # type of function, identification, version, load case; response; 0 and NONE: no reference
            f"{function.kind:5d}{0:10d}{0:5d}{0:10d}{node}",
            f"{form}{function.first:13.5E}{function.increment:13.5E}{0.0:13.5E}",
            *axes,
            *_numbers(function.values),
        ],
    )


def _numbers(values: FloatArray) -> list[str]:
    """Return the records of values, four numbers each; the last one may have fewer."""
    full = values.size // 4 * 4
    rows = (("%20.12E" * 4 + "\n") * (full // 4) % tuple(values[:full])).splitlines()
    rest = values[full:]
    return [*rows, "%20.12E" * rest.size % tuple(rest)] if np.size(rest) else rows


def _dataset(number: int, records: list[str]) -> str:
    return "\n".join([f"{-1:6d}", f"{number:6d}", *records, f"{-1:6d}"]) + "\n"
