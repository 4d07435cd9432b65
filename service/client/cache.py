"""Results on disk, named by the hash of their input, verified by the digest of their bytes at every read."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from pathlib import Path
from typing import Any

from service.schemas.result_kinds import suffix_of


class ResultCache:
    """A directory of result files; safe to share between processes, since every write is atomic."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory

    def put(self, kind: str, key: str, content: bytes) -> Path:
        """Keep a result."""
        file = self._file(kind, key)
        file.parent.mkdir(parents=True, exist_ok=True)
        _write(file, content)
        _write(_digest_file(file), hashlib.sha256(content).hexdigest().encode())
        return file

    def get(self, kind: str, key: str) -> Path | None:
        """Return the file of a result if it is here and undamaged; a damaged one is removed."""
        file = self._file(kind, key)
        try:
            wanted = _digest_file(file).read_text()
            with file.open("rb") as stream:
                found = hashlib.file_digest(stream, "sha256").hexdigest()
        except (OSError, UnicodeDecodeError):
            return None
        if found == wanted:
            return file
        file.unlink(missing_ok=True)
        _digest_file(file).unlink(missing_ok=True)
        return None

    def remember(self, service: str, inputs: dict[str, Any], key: str) -> None:
        """Note which result a service gave for these inputs, for the time it cannot be reached."""
        file = self._request_file(service, inputs)
        file.parent.mkdir(parents=True, exist_ok=True)
        _write(file, json.dumps({"key": key}).encode())

    def recall(self, service: str, inputs: dict[str, Any]) -> str | None:
        """Return the key of the result given for these inputs before."""
        try:
            key = json.loads(self._request_file(service, inputs).read_text())["key"]
        except (OSError, ValueError, KeyError, TypeError):
            return None
        return key if isinstance(key, str) else None

    def _file(self, kind: str, key: str) -> Path:
        """Return the file of a result; the name is hashed again unless it is a plain hash."""
        plain = len(key) == 64 and set(key) <= set("0123456789abcdef")
        name = key if plain else hashlib.sha256(key.encode("utf-8", "replace")).hexdigest()
        return self._directory / kind / f"{name}{suffix_of(kind)}"

    def _request_file(self, service: str, inputs: dict[str, Any]) -> Path:
        """Return the note of a request."""
        text = json.dumps({"service": service, "inputs": inputs}, sort_keys=True)
        return self._directory / "requests" / f"{hashlib.sha256(text.encode()).hexdigest()}.json"


def _digest_file(file: Path) -> Path:
    """Return the file that holds the digest of `file`."""
    return file.with_suffix(".sha256")


def _write(file: Path, content: bytes) -> None:
    """Write a file so that a reader sees the old or the new one, never half of it."""
    descriptor, name = tempfile.mkstemp(dir=file.parent, prefix=".", suffix=".part")
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(name).replace(file)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
