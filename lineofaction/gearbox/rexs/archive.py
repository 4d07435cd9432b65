"""The ZIP form of REXS (``.rexsz``, ``.rexs.zip``): a model and the files it names, read within bounds."""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path

from lineofaction.gearbox.rexs.model import Document, Model
from lineofaction.gearbox.rexs.refusal import MOST_BYTES, MOST_FILES, MOST_RATIO, refused

# Files that a model names (`data_source` and others): from its archive or from its folder, nothing else.


MODEL_NAME = "rexs-model.rexs"
_MODEL_ENDINGS = (".rexs", ".rexsj")
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)


def read_archive(data: bytes) -> tuple[str, bytes, dict[str, bytes]]:
    """Return the name and text of the model, and the other files by name.

    Raises
    ------
    BadInput
        It is no ZIP, is too large, names a file outside itself or one twice, or has no model or several.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = _files(archive, len(data))
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        NotImplementedError,
        RuntimeError,
        ValueError,
        OSError,
    ):
        raise refused("archive", None, "a ZIP archive that can be read") from None
    models = [name for name in files if name.lower().endswith(_MODEL_ENDINGS)]
    if len(models) != 1:
        raise refused("archive", ", ".join(models) or None, "an archive of one model, .rexs or .rexsj")
    text = files.pop(models[0])
    return models[0], text, files


def write_archive(model: bytes, files: Mapping[str, bytes]) -> bytes:
    """Return an archive of a model's XML and its files, the same bytes at every time."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, data in [(MODEL_NAME, model), *sorted(files.items())]:
            entry = zipfile.ZipInfo(name, _FIRST_DAY)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def inside(name: str) -> bool:
    """Return whether a relative name stays in its folder on every system."""
    parts = re.split(r"[/\\]", name)
    return bool(name) and parts[0] != "" and ".." not in parts and ":" not in name and "\0" not in name


def _files(archive: zipfile.ZipFile, size: int) -> dict[str, bytes]:
    entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    if len(entries) > MOST_FILES:
        raise refused("archive", f"{len(entries)} files", f"at most {MOST_FILES}")
    files: dict[str, bytes] = {}
    left = min(MOST_BYTES, MOST_RATIO * size)
    for entry in entries:
        if not inside(entry.filename):
            raise refused("archive", entry.filename, "a name inside the archive")
        if entry.filename in files:
            raise refused("archive", entry.filename, "in the archive once")
        files[entry.filename] = _read(archive, entry, left)
        left -= len(files[entry.filename])
    return files


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, most: int) -> bytes:
    """Return a file of an archive, of at most so many bytes, whatever the archive says."""
    with archive.open(entry) as stream:
        data = stream.read(most + 1)
    if len(data) > most:
        bound = f"at most {MOST_BYTES} bytes and {MOST_RATIO} times its archive"
        raise refused("archive", f"{entry.filename}, larger", bound)
    return data


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
