"""Free-form flanks as CSV files that a case file names: read and written out in the case."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.csv_rows import Nodes, complete_grid, csv_rows, number_in
from lineofaction.gearbox.schemas.named_files import Find, Table

FIELD = "flank_grid_csv"
COLUMNS = ("roll_length_mm", "face_position_mm", "removed_um")
_HELP = "See docs/case-file.md: one row per node, in any order."
_MAX_NODES = 1_000_000
"""Most nodes that a CSV file is read for."""


def with_flank_grids(
    table: Table, find: Find, read_text: Callable[[Path, str], str], prefix: str = ""
) -> dict[str, Any]:
    """Return `table`, which stands at `prefix` in its file, with `flank_grid` for every `flank_grid_csv`.

    `read_text` returns the text of a file, by its name for errors, or raises `BadInput`.
    """
    resolved = {
        key: _with_inner_grids(value, find, read_text, _joined(prefix, key)) for key, value in table.items()
    }
    if FIELD not in table:
        return resolved
    field, name = _joined(prefix, FIELD), resolved.pop(FIELD)
    if not isinstance(name, str):
        raise BadInput.of(field, name, "the name of a CSV file in quotes", _HELP)
    if "flank_grid" in table:
        raise BadInput.of(field, name, "left out when flank_grid is given", "Give one of the two.")
    file = find(name, field)
    try:
        text = read_text(file, name)
    except BadInput as error:
        raise error.within(field) from None
    return resolved | {"flank_grid": flank_grid(text, field, name)}


def _with_inner_grids(
    value: object, find: Find, read_text: Callable[[Path, str], str], prefix: str
) -> object:
    """Look for grids inside a table or a list."""
    if isinstance(value, dict):
        return with_flank_grids(value, find, read_text, prefix)
    if isinstance(value, list):
        return [_with_inner_grids(item, find, read_text, f"{prefix}[{i}]") for i, item in enumerate(value)]
    return value


def _joined(prefix: str, key: str) -> str:
    return f"{prefix}.{key}" if prefix else key


def flank_grid(text: str, field: str, name: str) -> Table:
    """Return the grid that the text of a CSV file holds.

    Raises `BadInput`: another heading, something that is no number, a node given twice or not at all.

    Parameters
    ----------
    text : str
        A heading with the three columns in any order, then one row per node in any order; lines that start
        with # are comments.
    field, name : str
        The field of the case and the file it names, for errors.

    Returns
    -------
    dict
        Of the form of `FlankGridInput`.
    """
    try:
        axes = complete_grid(_nodes(text), (COLUMNS[0], COLUMNS[1]))
    except ValueError as fault:
        raise BadInput.of(field, name, str(fault), _HELP) from None
    return dict(zip(COLUMNS, axes, strict=True))


def _nodes(text: str) -> Nodes:
    """Return the removed material by roll length and face position; `ValueError`: the required content."""
    file = csv_rows(text, _MAX_NODES)
    if sorted(file.heading) != sorted(COLUMNS):
        raise ValueError(
            f"a CSV file whose heading is {','.join(COLUMNS)} in any order, with commas; it is {file.heading}"
        )
    nodes: Nodes = {}
    for number, row in file.rows():
        roll, face, removed = (number_in(row, column, number) for column in COLUMNS)
        if (roll, face) in nodes:
            raise ValueError(f"a file that gives each node once; line {number} repeats one")
        nodes[roll, face] = removed
    return nodes
