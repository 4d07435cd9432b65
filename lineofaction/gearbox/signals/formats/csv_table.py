"""CSV files: a heading whose names end in units, then one row per time."""

from __future__ import annotations

import csv
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile, wanted
from lineofaction.gearbox.signals.units import unit_of_name

EXTRA = ""
TIMES = {"time_s": 1.0, "time_ms": 1e-3}
_REMEDY = "For example: time_s,speed_rpm,torque_n_m."


def channels(file: Path, names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield the columns except the time; raises `UnusableFile`: a line holds something else than numbers."""
    try:
        with file.open(encoding="utf-8-sig", newline="") as stream:
            heading = [name.strip() for name in next(csv.reader(stream), [])]
            scale = _scale(heading)
            rows = _rows(stream, len(heading))
    except (UnicodeDecodeError, csv.Error):
        raise UnusableFile("a text file in UTF-8 with commas", _REMEDY) from None
    budget = SampleBudget()
    for index, name in enumerate(heading[1:], start=1):
        if wanted(name, names):
            budget.take(len(rows))
            yield RawChannel(name, rows[:, index], scale * rows[:, 0], unit_of_name(name))


def _scale(heading: Sequence[str]) -> float:
    """Return the unit of the times in s."""
    scale = TIMES.get(heading[0]) if heading else None
    if scale is None or len(set(heading)) < len(heading):
        raise UnusableFile(f"a CSV file whose first column is {' or '.join(TIMES)}, each name once", _REMEDY)
    return scale


def _rows(stream: Iterator[str], columns: int) -> np.ndarray:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a file without rows
            rows = np.loadtxt(stream, delimiter=",", ndmin=2)
    except ValueError as error:
        raise UnusableFile(f"a CSV file of numbers alone below its heading ({error})", _REMEDY) from None
    if rows.size and rows.shape[1] != columns:
        raise UnusableFile(f"a CSV file with {columns} values in each row; it has {rows.shape[1]}", _REMEDY)
    return rows.reshape(-1, columns)
