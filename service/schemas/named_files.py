"""Where the files are that a case or scene names: beside its own file, or given together with its text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

from service.problems import BadInput
from service.schemas.file_content import FileContentInput

Find: TypeAlias = Callable[[str, str], Path]
"""From the name of a file and the field that has it to where it is; raises `BadInput`."""
_FOLDERS = re.compile(r"[/\\]")


def beside(folder: Path) -> Find:
    """Return what finds files by their names relative to a folder."""
    return lambda name, _field: folder / name


def own_name(name: str) -> str:
    """Return the name of a file without its folders, of any system."""
    return _FOLDERS.split(name)[-1]


@contextmanager
def given_files(files: Sequence[FileContentInput]) -> Iterator[Find]:
    """Write files into folders of their own; what is yielded finds them by their own names, and no others.

    Raises
    ------
    BadInput
        Two files have one name, a name is none, or a content is damaged or too large.
    """
    with TemporaryDirectory() as folder:
        places: dict[str, Path] = {}
        for index, file in enumerate(files):
            name = own_name(file.name)
            if name in places:
                raise BadInput.of(f"files[{index}].name", name, "given once", "Rename one of the files.")
            places[name] = _written(file, Path(folder) / str(index), f"files[{index}]")

        def find(name: str, field: str) -> Path:
            if own_name(name) not in places:
                known = f"one of {', '.join(places)}" if places else "a file given with the text"
                raise BadInput.of(field, name, known, "Give it together with the text that names it.")
            return places[own_name(name)]

        yield find


def _written(file: FileContentInput, folder: Path, field: str) -> Path:
    """Write a file into a new folder, and return where it is."""
    try:
        content = file.unpacked()
    except ValueError as error:
        raise BadInput.of(f"{field}.content", file.name, str(error)) from None
    place = folder / own_name(file.name)
    try:
        folder.mkdir()
        place.write_bytes(content)
    except (OSError, ValueError):
        raise BadInput.of(f"{field}.name", file.name, "a name that a file can have") from None
    return place
