"""Compiled sums of a front: the updates of its children and the matrices of its elements.

The blocks of a front are parts of the lower triangle of its matrix, column by column in flat memory: of the
inner freedoms (i, i), of the border by the inner ones (b, i), and of the border (b, b). After the elimination
of the inner freedoms the border block holds the update of the parent front. An update is stored as the lower
triangle, its columns packed: the first has b numbers, the last one.
"""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray, IntArray
from host.loops import inner, njit


@njit(cache=True)
def add_updates(
    within: FloatArray,
    below: FloatArray,
    rest: FloatArray,
    first: FloatArray,
    first_rows: IntArray,
    second: FloatArray,
    second_rows: IntArray,
    count: int,
) -> None:
    """Clear the three blocks of a front with `count` inner freedoms and add what two children pass up.

    Updates go to increasing rows of the front; without children there are no rows. Column by column, so that
    each is still in the processor's cache when the second child comes.
    """
    border = _rows_of(below, rest, count)
    ends_of_first, ends_of_second = _run_ends(first_rows, count), _run_ends(second_rows, count)
    column_of_first = column_of_second = 0
    for j in range(count + border):
        if j < count:
            upper, lower = within[j * count : (j + 1) * count], below[j * border : (j + 1) * border]
            upper[j:] = 0.0
            lower[:] = 0.0
        else:
            upper, lower = within[:0], rest[(j - count) * border : (j - count + 1) * border]
            lower[j - count :] = 0.0
        if column_of_first < len(first_rows) and first_rows[column_of_first] == j:
            _add_column(upper, lower, first, first_rows, ends_of_first, column_of_first, count)
            column_of_first += 1
        if column_of_second < len(second_rows) and second_rows[column_of_second] == j:
            _add_column(upper, lower, second, second_rows, ends_of_second, column_of_second, count)
            column_of_second += 1


@njit(cache=True)
def pack(rest: FloatArray, update: FloatArray) -> None:
    """Copy the lower triangle of a square matrix to the packed columns of an update."""
    rows, packed = int(np.round(np.sqrt(len(rest)))), 0
    for j in range(rows):
        column = rest[j * rows + j : (j + 1) * rows]
        update[packed : packed + rows - j] = column
        packed += rows - j


@inner()
def _rows_of(below: FloatArray, rest: FloatArray, count: int) -> int:
    """Return the number of border freedoms."""
    return len(below) // count if count else int(np.round(np.sqrt(len(rest))))


@inner()
def _run_ends(rows: IntArray, count: int) -> IntArray:
    """Return where the run of successive rows ends in which each row lies; no run goes past row `count`."""
    ends = np.empty(len(rows), dtype=np.int64)
    for i in range(len(rows) - 1, -1, -1):
        goes_on = i + 1 < len(rows) and rows[i + 1] == rows[i] + 1 and rows[i + 1] != count
        ends[i] = ends[i + 1] if goes_on else i + 1
    return ends


@inner()
def _add_column(
    upper: FloatArray,
    lower: FloatArray,
    update: FloatArray,
    rows: IntArray,
    ends: IntArray,
    column: int,
    count: int,
) -> None:
    """Add the lower part of a column of an update to the inner and border rows of the front's column."""
    before = column * len(rows) - column * (column - 1) // 2  # numbers in the columns before
    values = update[before - column :]  # so that row i of the column is its number i
    i = column
    while i < len(rows):
        end, row = ends[i], rows[i]
        target = upper[row:] if row < count else lower[row - count :]
        run = values[i:end]
        for k in range(len(run)):
            target[k] += run[k]
        i = end


@njit(cache=True)
def add_elements(
    within: FloatArray,
    below: FloatArray,
    rest: FloatArray,
    matrices: FloatArray,
    of_element: IntArray,
    rows: IntArray,
    count: int,
) -> None:
    """Add element matrices at rows `rows` (e, 60) of a front with `count` inner freedoms; -1 is held."""
    border = _rows_of(below, rest, count)
    for e in range(len(of_element)):
        local = matrices[of_element[e]]
        for i in range(rows.shape[1]):
            for j in range(rows.shape[1]):
                row, column = rows[e, i], rows[e, j]
                if column < 0 or row < column:
                    continue
                if row < count:
                    within[row + column * count] += local[i, j]
                elif column < count:
                    below[row - count + column * border] += local[i, j]
                else:
                    rest[row - count + (column - count) * border] += local[i, j]
