"""Force queries as raw columns of little-endian float64: exact, and without numpy."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Collection, Mapping

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.query import QueryOutput, validity_words

Column = float | Collection[float]
"""One value for all points, or a list or one-dimensional array with one for each."""


def query_columns(columns: Mapping[str, Column]) -> bytes:
    """Return columns one after the other; one value is repeated for all points.

    Raises
    ------
    BadInput
        The columns are of different lengths.
    """
    lists = {name: _values(column) for name, column in columns.items()}
    size = max(len(values) for values in lists.values())
    for name, values in lists.items():
        if len(values) not in (1, size):
            advice = "Give as many values in every list, or one for all points."
            raise BadInput.of(name, f"{len(values)} values", f"a list of {size} values, or of one", advice)
    return b"".join(_swapped(v if len(v) == size else v * size).tobytes() for v in lists.values())


def read_answer(content: bytes) -> QueryOutput:
    """Return force, stiffness and validity from their columns."""
    values = array("d")
    values.frombytes(content)
    numbers = _swapped(values).tolist()
    size = len(numbers) // 3
    return QueryOutput.model_construct(
        force_n=numbers[:size],
        stiffness_n_per_um=numbers[size : 2 * size],
        validity=[validity_words(int(flags)) for flags in numbers[2 * size :]],
    )


def _values(column: Column) -> array[float]:
    """Return a column as an array."""
    return array("d", [column] if isinstance(column, int | float) else column)


def _swapped(values: array[float]) -> array[float]:
    """Return the values in little-endian order, or from it."""
    if sys.byteorder == "big":
        values.byteswap()
    return values
