"""The ZIP form of REXS (``.rexsz``, ``.rexs.zip``): a model and the files it names, read within bounds."""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Mapping

from lineofaction.gearbox.problems import BadInput

MOST_BYTES = 64_000_000
"""Of a file, and of an archive's files together."""
MOST_FILES = 1_000
MOST_RATIO = 200
"""Bytes of an archive's files by bytes of the archive; models compress 20 to 50 times."""

MODEL_NAME = "rexs-model.rexs"
_MODEL_ENDINGS = (".rexs", ".rexsj")
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)


def read_archive(data: bytes) -> tuple[str, bytes, dict[str, bytes]]:
    """Return the name and text of the model, and the other files by name."""
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
        raise BadInput.of("archive", None, "a ZIP archive that can be read") from None
    models = [name for name in files if name.lower().endswith(_MODEL_ENDINGS)]
    if len(models) != 1:
        raise BadInput.of("archive", ", ".join(models) or None, "an archive of one model, .rexs or .rexsj")
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


def _inside(name: str) -> bool:
    """Return whether a relative name stays in its folder on every system."""
    parts = re.split(r"[/\\]", name)
    return bool(name) and parts[0] != "" and ".." not in parts and ":" not in name and "\0" not in name


def _files(archive: zipfile.ZipFile, size: int) -> dict[str, bytes]:
    entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    if len(entries) > MOST_FILES:
        raise BadInput.of("archive", f"{len(entries)} files", f"at most {MOST_FILES}")
    files: dict[str, bytes] = {}
    left = min(MOST_BYTES, MOST_RATIO * size)
    for entry in entries:
        if not _inside(entry.filename):
            raise BadInput.of("archive", entry.filename, "a name inside the archive")
        if entry.filename in files:
            raise BadInput.of("archive", entry.filename, "in the archive once")
        files[entry.filename] = _read(archive, entry, left)
        left -= len(files[entry.filename])
    return files


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, most: int) -> bytes:
    """Return a file of an archive, of at most so many bytes, whatever the archive says."""
    with archive.open(entry) as stream:
        data = stream.read(most + 1)
    if len(data) > most:
        bound = f"at most {MOST_BYTES} bytes and {MOST_RATIO} times its archive"
        raise BadInput.of("archive", f"{entry.filename}, larger", bound)
    return data
