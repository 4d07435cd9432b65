"""Housings as files beside a scene file: matrices and solids are read and written out in the scene.

What is sent to be computed holds their content itself.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

from dynamics.solid_housing import MESH_SUFFIXES, STEP_SUFFIXES
from host import MissingExtra
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.named_files import Find
from lineofaction.gearbox.units import MM, as_typed

ROWS = "stiffness_matrix"
MATRIX_FILE, MODES_FILE = "stiffness_file", "modes_file"
STEP_FILE, MESH_FILE = "step_file", "mesh_file"
_BY_CLIENT = "Run the scene by loa or the Python client: they read the file and send its matrices."
Table = dict[str, Any]
Content: TypeAlias = tuple[Table, Table]
"""Fields of a file that those of its housing replace, and fields that replace those of the housing."""
Contents: TypeAlias = dict[tuple[str, Path], Content]


def with_housing_files(table: Table, find: Find, read: Collection[str]) -> Table:
    """Return the table of a scene with the content of the housings' files in place of their names.

    Parameters
    ----------
    table : dict
    find : callable
    read : collection of str
        The fields whose files are read: `READERS`, or `SENT` of files that came over HTTP.

    Raises
    ------
    BadInput
        A file that cannot be read or holds no housing.
    """
    housings = table.get("housings")
    if not isinstance(housings, list):
        return table
    contents: Contents = {}
    written = [_written_out(housing, find, read, contents, i) for i, housing in enumerate(housings)]
    return table | {"housings": written}


def _written_out(
    housing: object, find: Find, read: Collection[str], contents: Contents, index: int
) -> object:
    """One housing with the content of its file, which is read once however often it is named."""
    named = [field for field in READERS if isinstance(housing, dict) and not _is_content(housing.get(field))]
    if not isinstance(housing, dict) or not named:
        return housing
    field, name = f"housings[{index}].{named[0]}", housing[named[0]]
    if not isinstance(name, str):
        raise BadInput.of(field, name, "the name of a file in quotes", "See docs/case-file.md.")
    if ROWS in housing or len(named) > 1:
        others = " and ".join((ROWS, *(other for other in READERS if other != named[0])))
        raise BadInput.of(field, name, f"left out when {others} is given", "Keep one of them.")
    if named[0] not in read:
        raise BadInput.of(field, name, "left out: a service opens no netCDF files of its callers", _BY_CLIENT)
    own = {key: value for key, value in housing.items() if key != named[0] or key == MODES_FILE}
    file = find(name, field)
    if (named[0], file) not in contents:
        contents[named[0], file] = READERS[named[0]](file, field)
    below, above = contents[named[0], file]
    return below | own | above


def _is_content(value: object) -> bool:
    """Whether nothing names a file: it is left out, or written out already."""
    return value is None or isinstance(value, dict)


def _matrices(file: Path, field: str) -> Content:
    from dynamics.errors import InputError  # noqa: PLC0415 - the client reads scenes too, and stays light
    from dynamics.joints.housing import read_housing_matrices  # noqa: PLC0415

    try:
        matrices = read_housing_matrices(file)
    except InputError as error:
        advice = str(error.suggestion) or "See docs/case-file.md."
        raise BadInput.of(field, file.name, str(error.bound), advice) from None
    return {}, {f"{part}_matrix": matrix.tolist() for part, matrix in matrices.items()}


def _modes(file: Path, field: str) -> Content:
    """Return the matrices and the seats of a reduced housing."""
    try:
        modes: Any = import_module("dynamics.housings")  # an extra, which the client does without
    except MissingExtra as error:
        raise BadInput.of(field, file.name, "read where the extra is installed", f"{error}") from None
    from dynamics.errors import InputError, ResultError  # noqa: PLC0415

    try:
        part = modes.scene_housing(modes.ReducedHousing.from_netcdf(file), "")
    except ResultError as error:
        raise BadInput.of(field, file.name, "a reduced housing (NetCDF)", f"{error}") from None
    except InputError as error:
        fault = f"a housing that a scene takes: {error.field} {error.bound}"
        raise BadInput.of(field, file.name, fault, str(error.suggestion)) from None
    matrices = {f"{name}_matrix": getattr(part, name) for name in ("stiffness", "damping", "mass")}
    places = [[as_typed(value, MM) for value in point] for point in part.seat_positions or ()]
    derived = {"bushings": list(part.bushings), "modal_coordinates": part.modal_coordinates}
    given = {name: rows for name, rows in matrices.items() if rows is not None}
    return derived | {"seat_positions_mm": places}, given


def _solid(file: Path, field: str) -> Content:
    name = field.rpartition(".")[2]
    suffixes = STEP_SUFFIXES if name == STEP_FILE else MESH_SUFFIXES
    if file.suffix.lower() not in suffixes:
        raise BadInput.of(field, file.name, f"a file that ends in {', '.join(suffixes)}")
    if not file.is_file():
        raise BadInput.of(field, file.name, "a file that exists", "It is relative to the scene file.")
    try:
        return {}, {name: FileContentInput.of(file).model_dump(mode="json")}
    except OSError:
        raise BadInput.of(field, file.name, "a readable file", "Check its permissions.") from None
    except ValueError as error:
        raise BadInput.of(field, file.name, str(error)) from None


READERS: dict[str, Callable[[Path, str], Content]] = {
    MATRIX_FILE: _matrices,
    MODES_FILE: _modes,
    STEP_FILE: _solid,
    MESH_FILE: _solid,
}
"""What reads the files that a housing names, by the field that names them."""
SENT = READERS.keys() - {MODES_FILE}
"""Fields whose files are read of whoever sends them: HDF5 opens more than it is given."""
