"""Files that a model names (`data_source` and others): from its archive or from its folder, nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from lineofaction.gearbox.rexs.archive import inside
from lineofaction.gearbox.rexs.model import Document, Model
from lineofaction.gearbox.rexs.refusal import MOST_BYTES, refused

_KIND = "file_reference"


def external_files(model: Model) -> Iterator[tuple[str, str]]:
    """Yield the place of each attribute that names a file, and the name."""
    for place, component in model.all_components():
        for attribute in component.attributes:
            if attribute.kind == _KIND and attribute.value is not None:
                yield f"{place}, {attribute.id}", str(attribute.value)


def external_file(document: Document, name: str, place: str, folder: Path | None = None) -> bytes:
    """Return a file that a model names.

    Parameters
    ----------
    document : Document
        The model with the files of its archive.
    name, place : str
        As `external_files` yields them.
    folder : Path, optional
        The folder of a model that lies in no archive; without it only the archive is looked in.

    Raises
    ------
    BadInput
        The name leads outside the archive or the folder, also by a link, or to no file; it is too large.
    """
    if not inside(name):
        raise refused(place, name, "a file in the archive or folder of the model")
    key = name.replace("\\", "/")
    if key in document.files:
        return document.files[key]
    path = (folder / key).resolve() if folder else None
    if folder is None or path is None or not path.is_relative_to(folder.resolve()) or not path.is_file():
        raise refused(place, name, "a file in the archive or folder of the model")
    with path.open("rb") as stream:
        data = stream.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise refused(place, name, f"a file of at most {MOST_BYTES} bytes")
    return data
