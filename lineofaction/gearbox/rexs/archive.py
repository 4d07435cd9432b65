"""The ZIP form of REXS (``.rexsz``, ``.rexs.zip``): a model and the files it names, read within bounds."""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Mapping

from lineofaction.gearbox.problems import BadInput

MAX_BYTES = 64_000_000
"""Largest size in bytes of a file, and of all files of an archive together."""

_MAX_FILES = 1_000

_MAX_RATIO = 200
"""Largest ratio of the bytes of an archive's files to the bytes of the archive; models compress 20 to 50
times."""

_MODEL_NAME = "rexs-model.rexs"

_MODEL_ENDINGS = (".rexs", ".rexsj")

_FIRST_DAY = (1980, 1, 1, 0, 0, 0)

_UNREADABLE = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError, OSError)
"""Errors of the ZIP reader for an archive that is damaged, locked or of an unknown kind."""


def read_archive(data: bytes) -> tuple[bytes, dict[str, bytes]]:
    """Return the text of the model, and the other files of an archive by name."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = _unpacked(archive, len(data))
    except _UNREADABLE:
        raise BadInput.of("archive", None, "a ZIP archive that can be read") from None
    models = [name for name in files if name.lower().endswith(_MODEL_ENDINGS)]
    if len(models) != 1:
        raise BadInput.of("archive", ", ".join(models) or None, "an archive of one model, .rexs or .rexsj")
    return files.pop(models[0]), files


def archive_of(model: bytes, files: Mapping[str, bytes]) -> bytes:
    """Return an archive of a model's XML and its files, the same bytes at every time."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, data in [(_MODEL_NAME, model), *sorted(files.items())]:
            entry = zipfile.ZipInfo(name, _FIRST_DAY)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def _unpacked(archive: zipfile.ZipFile, size: int) -> dict[str, bytes]:
    entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    if len(entries) > _MAX_FILES:
        raise BadInput.of("archive", f"{len(entries)} files", f"at most {_MAX_FILES}")
    files: dict[str, bytes] = {}
    left = min(MAX_BYTES, _MAX_RATIO * size)
    for entry in entries:
        parts = re.split(r"[/\\]", entry.filename)  # a relative name that stays in its folder on every system
        if not parts[0] or ".." in parts or ":" in entry.filename or "\0" in entry.filename:
            raise BadInput.of("archive", entry.filename, "a name inside the archive")
        if entry.filename in files:
            raise BadInput.of("archive", entry.filename, "in the archive once")
        files[entry.filename] = _read(archive, entry, left)
        left -= len(files[entry.filename])
    return files


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, limit: int) -> bytes:
    """Return a file of an archive up to a limit in bytes; the size that the archive states is not trusted."""
    with archive.open(entry) as stream:
        data = stream.read(limit + 1)
    if len(data) > limit:
        bound = f"at most {MAX_BYTES} bytes and {_MAX_RATIO} times its archive"
        raise BadInput.of("archive", f"{entry.filename}, larger", bound)
    return data
