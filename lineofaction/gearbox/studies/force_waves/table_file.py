"""Tables of force waves as CSV: orders, and pressures with units in the names of their columns.

A heading, then a row per wave, speed and torque, in any order:

    temporal_order,spatial_order,speed_rpm,torque_n_m,radial_pressure_kpa,radial_phase_deg,...
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

import numpy as np

from dynamics.errors import InputError
from dynamics.force_waves import ForceWaveTable
from dynamics.force_waves.waves import MAX_ORDER
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.csv_rows import Cells, CsvRows, csv_rows, number_in
from lineofaction.gearbox.signals.units import ANGLE, SPEED, TORQUE, measured_unit, unit_of_name
from lineofaction.gearbox.studies.force_waves import MAX_CHARACTERS
from lineofaction.gearbox.units import RPM

MAX_ROWS = 50_000
LARGEST_PRESSURE = 1e8
"""Largest amplitude, Pa; a larger one is in another unit."""
LARGEST_PHASE = 200.0 * math.pi
"""Largest phase, rad; a larger one is in another unit."""
ORDERS = ("temporal_order", "spatial_order")
PRESSURE = "pressure"
QUANTITIES = {
    "speed": SPEED,
    "torque": TORQUE,
    "radial_pressure": PRESSURE,
    "radial_phase": ANGLE,
    "tangential_pressure": PRESSURE,
    "tangential_phase": ANGLE,
}
"""Quantity of each column by its name without the unit."""
EXAMPLES = ("speed_rpm", "torque_n_m", "radial_pressure_kpa", "radial_phase_deg")
_PRESSURES = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6}
_HELP = "See docs/how-to/force-waves.md: one row per wave, speed and torque."
_INTEGER = re.compile(r"[+-]?[0-9]{1,6}")
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")

_Key: TypeAlias = tuple[tuple[int, int], float, float]
"""Wave, speed and torque of a row."""


class _Column(NamedTuple):
    """A column of a file, and its unit in SI."""

    heading: str
    unit: float


class _Row(NamedTuple):
    """A wave at a speed and a torque, in SI."""

    wave: tuple[int, int]
    speed: float
    torque: float
    radial: complex
    tangential: complex


def force_wave_table(text: str, field: str) -> ForceWaveTable:
    """Return the table that the text of a CSV file holds.

    Raises `BadInput`: another heading, an unknown unit, a cell that is no number or beyond its bound, a row
    that stands there twice, a grid of waves, speeds and torques that is not complete, too many rows.

    Parameters
    ----------
    text : str
        A heading with the columns of `ORDERS` and `QUANTITIES` in any order, then one row per wave, speed and
        torque in any order; lines that start with # are comments.
    field : str
        The field that has the text, for errors.
    """
    try:
        if len(text) > MAX_CHARACTERS:
            raise ValueError(f"a file of at most {MAX_CHARACTERS} characters")
        return _table(_rows(csv_rows(text, MAX_ROWS)))
    except ValueError as fault:
        raise BadInput.of(field, None, str(fault), _HELP) from None
    except InputError as fault:
        raise BadInput.of(field, None, f"a table of waves: {fault}", _HELP) from None


def _rows(file: CsvRows) -> dict[_Key, _Row]:
    """Return the rows of a file by wave, speed and torque; `ValueError`: the required content."""
    columns = _columns(file.heading)
    rows: dict[_Key, _Row] = {}
    for number, cells in file.rows():
        row = _row(cells, columns, number)
        key = (row.wave, row.speed, row.torque)
        if key in rows:
            raise ValueError(
                f"a file that gives each wave once at a speed and torque; line {number} repeats one"
            )
        rows[key] = row
    if not rows:
        raise ValueError("a file with a row per wave, speed and torque; it has a heading alone")
    return rows


def _columns(heading: list[str]) -> dict[str, _Column]:
    """Return the columns by the names of their quantities."""
    columns = {name: _Column(name, 1.0) for name in ORDERS if name in heading}
    for name, quantity in QUANTITIES.items():
        matching = [column for column in heading if column.startswith(f"{name}_")]
        if len(matching) > 1:
            raise ValueError(f"a file with one column of {name}; it has {', '.join(matching)}")
        if matching:
            columns[name] = _Column(matching[0], _unit(matching[0], name, quantity))
    missing = [name for name in (*ORDERS, *QUANTITIES) if name not in columns]
    if missing:
        raise ValueError(f"a file with columns of {', '.join(missing)} too, as {', '.join(EXAMPLES)}")
    known = [column.heading for column in columns.values()]
    if sorted(known) != sorted(heading):
        odd = sorted(set(heading) - set(known)) or heading
        raise ValueError(f"a file whose heading names {', '.join(known)} once and nothing else; it has {odd}")
    return columns


def _unit(column: str, name: str, quantity: str) -> float:
    """Return the SI value of the unit that ends the name of a column."""
    ending = column.removeprefix(f"{name}_")
    if quantity == PRESSURE:
        if ending not in _PRESSURES:
            raise ValueError(
                f"a file with a unit of pressure, {', '.join(_PRESSURES)}; it has the column {column}"
            )
        return _PRESSURES[ending]
    unit = measured_unit(unit_of_name(f"_{ending}") or ending)
    if unit is None or unit.quantity != quantity:
        raise ValueError(
            f"a file with a unit of {quantity} as in {', '.join(EXAMPLES)}; it has the column {column}"
        )
    return unit.factor


def _row(cells: Cells, columns: Mapping[str, _Column], line: int) -> _Row:
    temporal, spatial = (_order(cells, name, line) for name in ORDERS)
    values = {name: _number(cells, columns[name], line) for name in QUANTITIES}
    if temporal < 0:
        raise ValueError(
            f"a file of temporal orders >= 0; line {line} has {temporal}. A wave against the rotor "
            "has a negative spatial order"
        )
    if values["speed"] < 0.0:
        raise ValueError(f"a file of speeds >= 0; line {line} has a negative one")
    radial, tangential = (_pressure(values, name, line) for name in ("radial", "tangential"))
    return _Row((temporal, spatial), values["speed"], values["torque"], radial, tangential)


def _order(cells: Cells, column: str, line: int) -> int:
    cell = cells[column]
    if not _INTEGER.fullmatch(cell) or abs(int(cell)) > MAX_ORDER:
        raise ValueError(
            f"a file of whole orders up to {MAX_ORDER}; line {line} holds {cell[:40]!r} in {column}"
        )
    return int(cell)


def _number(cells: Cells, column: _Column, line: int) -> float:
    """Return a number in SI; spellings of Python alone, such as 1_000, are refused."""
    value = number_in(cells, column.heading, line) * column.unit
    if not _NUMBER.fullmatch(cells[column.heading]) or not math.isfinite(value):
        preview = cells[column.heading][:40]
        raise ValueError(f"a file of finite numbers; line {line} holds {preview!r} in {column.heading}")
    return value


def _pressure(values: Mapping[str, float], name: str, line: int) -> complex:
    """Return the complex amplitude of a pressure, Pa."""
    amplitude, phase = values[f"{name}_pressure"], values[f"{name}_phase"]
    if not 0.0 <= amplitude <= LARGEST_PRESSURE:
        raise ValueError(
            f"a file of amplitudes from 0 to {LARGEST_PRESSURE / 1e6:g} MPa; line {line} has {amplitude:g} Pa"
        )
    if abs(phase) > LARGEST_PHASE:
        raise ValueError(f"a file of phases up to 100 turns; line {line} has {phase:g} rad")
    return complex(amplitude * np.exp(1j * phase))


def _table(rows: Mapping[_Key, _Row]) -> ForceWaveTable:
    """Return the table of a complete grid."""
    waves = sorted({row.wave for row in rows.values()})
    speeds = sorted({row.speed for row in rows.values()})
    torques = sorted({row.torque for row in rows.values()})
    grid = ((wave, speed, torque) for wave in waves for speed in speeds for torque in torques)
    count = len(waves) * len(speeds) * len(torques)
    if count != len(rows):
        (k, r), speed, torque = next(key for key in grid if key not in rows)
        raise ValueError(
            f"a complete grid: {count - len(rows)} of {count} rows are missing, the first at temporal "
            f"order {k}, spatial order {r}, {speed / RPM:.6g} rpm, {torque:.6g} N m"
        )
    values = np.array([(rows[key].radial, rows[key].tangential) for key in grid])
    radial, tangential = values.T.reshape(2, len(waves), len(speeds), len(torques))
    temporal, spatial = np.array(waves).T
    return ForceWaveTable(temporal, spatial, np.array(speeds), np.array(torques), radial, tangential)
