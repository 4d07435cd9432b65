"""Files that a case or scene names, read and written out in it: solids, responses, matrices, flanks."""

from __future__ import annotations

import base64
import binascii
import re
import zlib
from collections.abc import Callable, Collection, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, Self, TypeAlias

from pydantic import Field

from dynamics.solid_housing import MESH_SUFFIXES, STEP_SUFFIXES
from host import MissingExtra
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.csv_rows import Nodes, csv_rows, number_in, whole_grid
from lineofaction.gearbox.schemas.load_signals import with_load_signals
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.signals import UNIVERSAL
from lineofaction.gearbox.units import MM, as_typed

Find: TypeAlias = Callable[[str, str], Path]
"""From the name of a file and the field that has it to where it is; raises `BadInput`."""
_FOLDERS = re.compile(r"[/\\]")
LARGEST = 64_000_000
"""Bytes of a file, or of all files of a request, unpacked."""
_LARGEST_TEXT = 24_000_000
ROWS = "stiffness_matrix"
MATRIX_FILE, MODES_FILE = "stiffness_file", "modes_file"
STEP_FILE, MESH_FILE, RESPONSE_FILE = "step_file", "mesh_file", "frf_file"
_CONTENT_SUFFIXES = {STEP_FILE: STEP_SUFFIXES, MESH_FILE: MESH_SUFFIXES, RESPONSE_FILE: UNIVERSAL}
"""How the files end whose content goes along with the scene, by the fields that name them."""
_BY_CLIENT = "Run the scene by loa or the Python client: they read the file and send its matrices."
Table = dict[str, Any]
Content: TypeAlias = tuple[Table, Table]
"""Fields of a file that those of its housing replace, and fields that replace those of the housing."""
Contents: TypeAlias = dict[tuple[str, Path], Content]
FIELD = "flank_grid_csv"
COLUMNS = ("roll_length_mm", "face_position_mm", "removed_um")
_HELP = "See docs/case-file.md: one row per node, in any order."
_LARGEST_FILE, _MOST_NODES = 16_000_000, 1_000_000


def beside(folder: Path) -> Find:
    """Return what finds files by their names relative to a folder."""
    return lambda name, _field: folder / name


def own_name(name: str) -> str:
    """Return the name of a file without its folders, of any system."""
    return _FOLDERS.split(name)[-1]


# A file inside a scene: its name, and what it holds, compressed.


class FileContentInput(BoundaryModel):
    """A file of the caller, written out: a service reads no files of its callers."""

    name: str = Field(
        min_length=1, max_length=255, description="Name of the file, with its ending", examples=["case.step"]
    )
    content: str = Field(
        min_length=1,
        max_length=_LARGEST_TEXT,
        description="What it holds, compressed by zlib and written in Base64",
        examples=["eJwDAAAAAAE="],
    )

    @classmethod
    def of(cls, file: Path) -> Self:
        """Return the content of a file; raises OSError, and ValueError if it is too large."""
        if file.stat().st_size > LARGEST:
            raise ValueError(f"at most {LARGEST} bytes")
        return cls.packed(file.name, file.read_bytes())

    @classmethod
    def packed(cls, name: str, content: bytes) -> Self:
        """Return a file of a name that holds these bytes."""
        return cls(name=name, content=base64.b64encode(zlib.compress(content, 9)).decode("ascii"))

    def unpacked(self, most: int = LARGEST) -> bytes:
        """Return what the file holds; raises ValueError if it is damaged or has more than so many bytes."""
        reader = zlib.decompressobj()
        try:
            data = reader.decompress(base64.b64decode(self.content, validate=True), most + 1)
        except (binascii.Error, zlib.error):
            raise ValueError("compressed by zlib and written in Base64") from None
        if len(data) > most or not reader.eof:
            raise ValueError(f"whole, and with all other files at most {LARGEST} bytes when unpacked")
        return data


# Housings as files beside a scene file: matrices and solids are read and written out in the scene.


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
    """One housing with the content of its file, which is read once however often it is named."""
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
    own = {key: value for key, value in housing.items() if key != named[0] or key == MODES_FILE}
    file = find(name, field)
    if (named[0], file) not in contents:
        contents[named[0], file] = READERS[named[0]](file, field)
    below, above = contents[named[0], file]
    return below | own | above


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
    present = {name: rows for name, rows in matrices.items() if rows is not None}
    return derived | {"seat_positions_mm": places}, present


def _whole(file: Path, field: str) -> Content:
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
            path = Path(own_name(content["name"]))
            yield field, path.stem, path.suffix, FileContentInput(**content)
    rows = housing.get(ROWS)
    if rows is not None and not any(f"{part}_matrix" in housing for part in ("damping", "mass")):
        text = "".join(f"{','.join(map(repr, row))}\n" for row in rows)
        stem = re.sub(r"\W+", "_", str(housing.get("name", ""))).strip("_").lower() or "housing"
        yield MATRIX_FILE, stem[:100], "_stiffness.csv", FileContentInput.packed("matrix.csv", text.encode())


READERS: dict[str, Callable[[Path, str], Content]] = {
    MATRIX_FILE: _matrices,
    MODES_FILE: _modes,
    **dict.fromkeys(_CONTENT_SUFFIXES, _whole),
}
"""What reads the files that a housing names, by the field that names them."""
SENT = READERS.keys() - {MODES_FILE}
"""Fields whose files are read of whoever sends them: HDF5 opens more than it is given."""


# Free-form flanks as CSV files beside a case file: read and written out in the case.


def _with_flank_grids(
    table: Table, find: Find, read_text: Callable[[Path, str], str], prefix: str = ""
) -> dict[str, Any]:
    """Return `table`, which stands at `prefix` in its file, with `flank_grid` for every `flank_grid_csv`.

    `read_text` returns the text of a file, by its name for errors, or raises `BadInput`.
    """
    resolved = {key: _inside(value, find, read_text, _joined(prefix, key)) for key, value in table.items()}
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


def _inside(value: object, find: Find, read_text: Callable[[Path, str], str], prefix: str) -> object:
    """Look for grids inside a table or a list."""
    if isinstance(value, dict):
        return _with_flank_grids(value, find, read_text, prefix)
    if isinstance(value, list):
        return [_inside(item, find, read_text, f"{prefix}[{i}]") for i, item in enumerate(value)]
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
        axes = whole_grid(_nodes(text), (COLUMNS[0], COLUMNS[1]))
    except ValueError as fault:
        raise BadInput.of(field, name, str(fault), _HELP) from None
    return dict(zip(COLUMNS, axes, strict=True))


def _nodes(text: str) -> Nodes:
    """Material removed by roll length and face position; `ValueError` says what the file must hold."""
    file = csv_rows(text, _MOST_NODES)
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


def read_text(path: Path, name: str) -> str:
    """Return the text of a file; raises `BadInput` with the name that its caller has for it."""
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise BadInput.of("file", name, f"at most {_LARGEST_FILE} bytes", "Is this the right file?")
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise BadInput.of("file", name, "a text file in UTF-8", "Is this the right file?") from None
    except OSError as error:
        reason = error.strerror or "unreadable"
        raise BadInput.of("file", name, "a readable file", f"{reason}. Check the path.") from None


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
    return _with_housing_files(_with_flank_grids(signals, find, read_text), find, housings)
