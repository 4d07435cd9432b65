"""The files that a caller sends together with a text: written into a folder, found there by their names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.file_content import LARGEST, FileContentInput
from lineofaction.gearbox.schemas.named_files import Find, own_name


def sent_files(files: Sequence[FileContentInput], folder: Path) -> Find:
    """Write files into folders of their own; what is returned finds them by their own names, and no others.

    Raises
    ------
    BadInput
        Two files have one name, a name is none, a content is damaged, or together they are too large.
    """
    places: dict[str, Path] = {}
    left = LARGEST
    for index, file in enumerate(files):
        name = own_name(file.name)
        if name in places:
            raise BadInput.of(f"files[{index}].name", name, "sent once", "Rename one of the files.")
        places[name] = _written(file, folder / str(index), f"files[{index}]", left)
        left -= places[name].stat().st_size

    def find(name: str, field: str) -> Path:
        if own_name(name) not in places:
            known = f"one of {', '.join(places)}" if places else "a file sent with the text"
            raise BadInput.of(field, name, known, "Send it together with the text that names it.")
        return places[own_name(name)]

    return find


def _written(file: FileContentInput, folder: Path, field: str, most: int) -> Path:
    """Write a file of at most so many bytes into a new folder, and return where it is."""
    try:
        content = file.unpacked(most)
    except ValueError as error:
        raise BadInput.of(f"{field}.content", file.name, str(error)) from None
    place = folder / own_name(file.name)
    try:
        folder.mkdir()
        place.write_bytes(content)
    except (OSError, ValueError):
        raise BadInput.of(f"{field}.name", file.name, "a name that a file can have") from None
    return place
