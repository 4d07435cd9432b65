"""The text of a case or scene file with the files that it names, read as routes answer it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from lineofaction.gearbox.convert.case import case_as_filed
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.file_content import LARGEST, FileContentInput
from lineofaction.gearbox.schemas.files import SENT, written_out
from lineofaction.gearbox.schemas.named_files import Find, base_name, read_text
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_table

Json = dict[str, Any]
Announce = Callable[[str], None]
"""Function that is called with the field of the inputs that is read next."""


def _sent_files(files: Sequence[FileContentInput], folder: Path, announce: Announce) -> Find:
    """Write files into a folder; return the function that finds these files by their own names.

    Raises `BadInput`: two files have one name, a name is not that of a file, a content is damaged, or all
    together are too large.
    """
    places: dict[str, Path] = {}
    fields: dict[str, str] = {}
    left = LARGEST
    for index, file in enumerate(files):
        name = base_name(file.name)
        if name in places:
            raise BadInput.of(f"files[{index}].name", name, "sent once", "Rename one of the files.")
        fields[name] = f"files[{index}]"
        places[name] = _written(file, folder, fields[name], left)
        left -= places[name].stat().st_size

    def find(name: str, field: str) -> Path:
        if base_name(name) not in places:
            known = f"one of {', '.join(places)}" if places else "a file sent with the text"
            raise BadInput.of(field, name, known, "Send it together with the text that names it.")
        announce(fields[base_name(name)])
        return places[base_name(name)]

    return find


def _written(file: FileContentInput, folder: Path, field: str, maximum: int) -> Path:
    """Write a file of at most so many bytes into a folder, and return where it is."""
    try:
        content = file.unpacked(maximum)
    except ValueError as error:
        raise BadInput.of(f"{field}.content", file.name, str(error)) from None
    path = folder / base_name(file.name)
    try:
        path.write_bytes(content)
    except (OSError, ValueError):
        raise BadInput.of(f"{field}.name", file.name, "a name that a file can have") from None
    return path


def case_of_toml(inputs: Json, folder: Path, announce: Announce) -> Json:
    """Return the case in ``{"toml": ..., "files": [...]}`` with all defaults; raises `BadInput`.

    The files are written into a folder.
    """
    return {"case": case_as_filed(validated(Case, _table(inputs, folder, announce, _written_out)))}


def scene_of_toml(inputs: Json, folder: Path, announce: Announce) -> Json:
    """Return the scene in ``{"toml": ..., "files": [...]}`` as it was written, without defaults.

    The names of case files that are not among the files stay: a scene read elsewhere may have them.

    Raises `BadInput`: with every fault of the text, or a file that it names is missing, damaged or holds
    something else.
    """
    names = {base_name(file["name"]) for file in inputs["files"]}
    table = _table(inputs, folder, announce, lambda table, find: _with_cases(table, find, names))
    scene = validated(SceneInput, table)
    return {"scene": scene.model_dump(mode="json", exclude_unset=True)}


def _table(inputs: Json, folder: Path, announce: Announce, with_files: Callable[[Json, Find], Json]) -> Json:
    files = [validated(FileContentInput, file) for file in inputs["files"]]
    find = _sent_files(files, folder, announce)
    return with_files(toml_table(inputs["toml"], "toml"), find)


def _written_out(table: Json, find: Find) -> Json:
    return written_out(table, find, SENT)


def _with_cases(table: Json, find: Find, names: set[str]) -> Json:
    """Return the table of a scene with the content of named files; of case files only those in `names`."""
    table, meshes = _written_out(table, find), table.get("meshes")
    if not isinstance(meshes, list):
        return table
    cases: dict[str, Json] = {}
    return table | {
        "meshes": [_with_case(mesh, find, names, cases, f"meshes[{i}]") for i, mesh in enumerate(meshes)]
    }


def _with_case(mesh: object, find: Find, names: set[str], cases: dict[str, Json], field: str) -> object:
    """Return the table of a mesh with its case in place of the name of its file; each is read once."""
    name = mesh.get("case_file") if isinstance(mesh, dict) else None
    if not isinstance(mesh, dict) or not isinstance(name, str) or base_name(name) not in names:
        return mesh
    field = f"{field}.case_file"
    if name not in cases:
        cases[name] = _written_out(toml_table(read_text(find(name, field), name), field), find)
    return {key: value for key, value in mesh.items() if key != "case_file"} | {"case": cases[name]}
