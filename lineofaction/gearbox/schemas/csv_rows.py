"""Rows of a CSV file from outside: a heading, then one row per point.

Every function raises `ValueError`, which says what the file must hold and which line does not.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

Cells: TypeAlias = dict[str, str]
Nodes: TypeAlias = dict[tuple[float, float], float]
_PREVIEW = 40
"""Characters of a cell that a message shows."""


@dataclass(frozen=True)
class CsvRows:
    """The lines of a file."""

    heading: list[str]
    data_lines: list[tuple[int, str]]
    """Number from 1 and text of each line after the heading that is neither blank nor a comment, which starts
    with #."""
    lines: int
    """Number of all lines."""

    @property
    def silent(self) -> int:
        """Blank lines and comments."""
        return self.lines - len(self.data_lines) - 1

    def rows(self) -> Iterator[tuple[int, Cells]]:
        """Yield number and cells of each row, by the heading and without spaces around them."""
        for number, line in self.data_lines:
            cells = _cells(line)
            if len(cells) != len(self.heading):
                count = len(self.heading)
                raise ValueError(f"a file with {count} values in each row; line {number} has {len(cells)}")
            yield number, dict(zip(self.heading, cells, strict=True))


def csv_rows(text: str, maximum: int) -> CsvRows:
    """Return the rows of a file of at most `maximum` points."""
    lines = text.removeprefix("\ufeff").splitlines()
    data_lines = [
        (n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if not data_lines:
        raise ValueError("a CSV file with a heading and a row per point; it is empty")
    if len(data_lines) > maximum + 1:
        raise ValueError(f"a file of at most {maximum} points")
    return CsvRows(_cells(data_lines[0][1]), data_lines[1:], len(lines))


def number_in(row: Cells, column: str, line: int) -> float:
    """Return the finite number in a column of a row."""
    cell = row[column]
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        preview = f"{cell[:_PREVIEW]!r}" if cell else "nothing"
        raise ValueError(f"a file of finite numbers; line {line} holds {preview} in {column}")
    return value


def complete_grid(nodes: Nodes, names: tuple[str, str]) -> tuple[list[float], list[float], list[list[float]]]:
    """Return the axes of values at nodes, by `names` in messages, and the values in rows."""
    first, second = (sorted({node[axis] for node in nodes}) for axis in (0, 1))
    count = len(first) * len(second)
    missing = count - len(nodes)
    if missing:
        missing_node = next((a, b) for a in first for b in second if (a, b) not in nodes)
        where = ", ".join(f"{name} = {value:.12g}" for name, value in zip(names, missing_node, strict=True))
        raise ValueError(f"a complete grid: {missing} of {count} nodes are missing, the first at {where}")
    return first, second, [[nodes[a, b] for b in second] for a in first]


def _cells(line: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line]))]
    except csv.Error as fault:
        raise ValueError(f"a CSV file: {fault}") from None
