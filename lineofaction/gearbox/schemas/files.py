"""Files that the housings of a scene name: their content replaces the names; so for all files of a table."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

from dynamics.solid_housing import MESH_SUFFIXES, STEP_SUFFIXES
from host import MissingExtra
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.flank_grid_files import with_flank_grids
from lineofaction.gearbox.schemas.load_signals import with_load_signals
from lineofaction.gearbox.schemas.named_files import Find, Table, base_name, read_text
from lineofaction.gearbox.signals.endings import UNIVERSAL
from lineofaction.gearbox.units import MM, as_typed

ROWS = "stiffness_matrix"
MATRIX_FILE, MODES_FILE = "stiffness_file", "modes_file"
STEP_FILE, MESH_FILE, RESPONSE_FILE = "step_file", "mesh_file", "frf_file"
_CONTENT_SUFFIXES = {STEP_FILE: STEP_SUFFIXES, MESH_FILE: MESH_SUFFIXES, RESPONSE_FILE: UNIVERSAL}
"""Endings of the files whose content goes along with the scene, by the fields that name the files."""
_BY_CLIENT = "Run the scene by loa or the Python client: they read the file and send its matrices."
TEXTS = ("force_wave_table",)
"""Fields of a study that hold a CSV file, or its name on a line that ends in .csv."""
Content: TypeAlias = tuple[Table, Table]
"""Fields from a file that the fields of its housing override, and fields that override those."""
Contents: TypeAlias = dict[tuple[str, Path], Content]


def _with_housing_files(table: Table, find: Find, read: Collection[str]) -> Table:
    """Return the table of a scene with the content of the housings' files in place of their names.

    Files of the fields `read` are: `READERS`, or `SENT` of files that came over HTTP.
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
    """Return a housing with the content of its file; a file that several housings name is read once."""
    if not isinstance(housing, dict):
        return housing
    named = [field for field in READERS if not isinstance(housing.get(field), dict | None)]
    if not named:  # its files are left out, or written out already
        return housing
    field, name = f"housings[{index}].{named[0]}", housing[named[0]]
    if not isinstance(name, str):
        raise BadInput.of(field, name, "the name of a file in quotes", "See docs/case-file.md.")
    if ROWS in housing or len(named) > 1:
        others = " and ".join((ROWS, *(other for other in READERS if other != named[0])))
        raise BadInput.of(field, name, f"left out when {others} is given", "Keep one of them.")
    if named[0] not in read:
        raise BadInput.of(field, name, "left out: a service opens no netCDF files of its callers", _BY_CLIENT)
    inline = {key: value for key, value in housing.items() if key != named[0] or key == MODES_FILE}
    file = find(name, field)
    if (named[0], file) not in contents:
        contents[named[0], file] = READERS[named[0]](file, field)
    below, above = contents[named[0], file]
    return below | inline | above


def _matrices(file: Path, field: str) -> Content:
    from dynamics.errors import InputError  # noqa: PLC0415 - the client reads scenes too, and stays light
    from dynamics.joints.housing import read_housing_matrices  # noqa: PLC0415

    try:
        matrices = read_housing_matrices(file)
    except InputError as error:
        remedy = str(error.suggestion) or "See docs/case-file.md."
        raise BadInput.of(field, file.name, str(error.bound), remedy) from None
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
    positions_mm = [[as_typed(value, MM) for value in point] for point in part.seat_positions or ()]
    derived = {"bushings": list(part.bushings), "modal_coordinates": part.modal_coordinates}
    present = {name: rows for name, rows in matrices.items() if rows is not None}
    return derived | {"seat_positions_mm": positions_mm}, present


def _content(file: Path, field: str) -> Content:
    """Return a file whose content goes along: a solid, or measured responses."""
    name = field.rpartition(".")[2]
    suffixes = _CONTENT_SUFFIXES[name]
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


def side_files(scene: Table) -> tuple[Table, list[FileContentInput]]:
    """Return the table of a scene that names files, and these: `written_out` the other way round.

    Solids and measured responses of housings and their stiffness matrices become files; a housing with other
    matrices keeps them.
    """
    files: dict[str, FileContentInput] = {}

    def named(housing: Table) -> Table:
        names = {}
        for field, stem, ending, content in _contents(housing):
            number, name = 1, f"{stem}{ending}"
            # equal files share a name, others get a number
            while files.get(name, content).unpacked() != content.unpacked():
                number += 1
                name = f"{stem}_{number}{ending}"
            files[name] = content.model_copy(update={"name": name})
            names[field] = name
        inside = [field for field in (*_CONTENT_SUFFIXES, ROWS) if names and field in housing]
        return {key: value for key, value in housing.items() if key not in inside} | names

    housings = [named(housing) for housing in scene.get("housings", ())]
    return scene | ({"housings": housings} if housings else {}), list(files.values())


def _contents(housing: Table) -> Iterator[tuple[str, str, str, FileContentInput]]:
    """Yield the fields that name the files of a housing, how the names begin and end, and their content."""
    for field in _CONTENT_SUFFIXES:
        if isinstance(content := housing.get(field), dict):
            path = Path(base_name(content["name"]))
            yield field, path.stem, path.suffix, FileContentInput(**content)
    rows = housing.get(ROWS)
    if rows is not None and not any(f"{part}_matrix" in housing for part in ("damping", "mass")):
        text = "".join(f"{','.join(map(repr, row))}\n" for row in rows)
        stem = re.sub(r"\W+", "_", str(housing.get("name", ""))).strip("_").lower() or "housing"
        yield MATRIX_FILE, stem[:100], "_stiffness.csv", FileContentInput.packed("matrix.csv", text.encode())


READERS: dict[str, Callable[[Path, str], Content]] = {
    MATRIX_FILE: _matrices,
    MODES_FILE: _modes,
    **dict.fromkeys(_CONTENT_SUFFIXES, _content),
}
"""Readers of the files that a housing names, by the field that names the file."""
SENT = READERS.keys() - {MODES_FILE}
"""Fields whose files are read for any sender. The HDF5 of a file of modes can open further files."""


def written_out(table: dict[str, Any], find: Find, housings: Collection[str]) -> dict[str, Any]:
    """Return a table with the content of the flank grids, housings and recordings that it names as files.

    Raises `BadInput`: a file is missing, or holds something else.

    Parameters
    ----------
    housings : collection of str
        The fields of housings whose files are read, see `_with_housing_files`. Recordings are read where
        netCDF files are: not by a service, whose callers send numbers.
    """
    signals = with_load_signals(table, find, read=MODES_FILE in housings)
    return _with_housing_files(with_flank_grids(_with_texts(signals, find), find, read_text), find, housings)


def _with_texts(table: Table, find: Find) -> Table:
    """Return the table of a study with the text of the CSV files that it names in `TEXTS`."""
    texts = {}
    for field in TEXTS:
        name = table.get(field)
        if isinstance(name, str) and "\n" not in name and name.endswith(".csv"):
            try:
                texts[field] = read_text(find(name, field), name)
            except BadInput as error:
                raise error.within(field) from None
    return table | texts
