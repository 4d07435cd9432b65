"""Housing matrices as files beside a scene file: read and written out in the scene.

Only files on the caller's own disk name other files; what goes over HTTP holds the matrix itself.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from service.problems import BadInput

FIELD, ROWS = "stiffness_file", "stiffness_matrix"
Table = dict[str, Any]


def with_housing_files(table: Table, folder: Path) -> Table:
    """Return the table of a scene with `stiffness_matrix` in place of the housings' `stiffness_file`.

    Raises
    ------
    BadInput
        A file that cannot be read or holds no matrix.
    """
    housings = table.get("housings")
    if not isinstance(housings, list):
        return table
    return table | {"housings": [_written_out(housing, folder, i) for i, housing in enumerate(housings)]}


def _written_out(housing: object, folder: Path, index: int) -> object:
    """One housing with its file's matrices."""
    from dynamics.errors import InputError  # noqa: PLC0415 - the client reads scenes too, and stays light
    from dynamics.joints.housing import read_housing_matrices  # noqa: PLC0415

    if not isinstance(housing, dict) or FIELD not in housing:
        return housing
    field, name = f"housings[{index}].{FIELD}", housing[FIELD]
    if not isinstance(name, str):
        raise BadInput.of(field, name, "the name of a CSV or NPZ file in quotes", "See docs/case-file.md.")
    if ROWS in housing:
        raise BadInput.of(field, name, f"left out when {ROWS} is given", "Give one of the two.")
    try:
        stiffness, damping = read_housing_matrices(folder / name)
    except InputError as error:
        raise BadInput.of(
            field, name, str(error.bound), str(error.suggestion) or "See docs/case-file.md."
        ) from None
    resolved = {key: value for key, value in housing.items() if key != FIELD} | {ROWS: stiffness.tolist()}
    return resolved if damping is None else resolved | {"damping_matrix": damping.tolist()}
