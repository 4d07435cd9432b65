"""Results on disk, named by the hash of their input and the digest of their bytes, compared at every read."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, BinaryIO, cast

from lineofaction.client.status import Result
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import SUFFIX

FIGURES = ".json"
"""Ending of the figures of results."""
SET_ASIDE = ".damaged"
"""Ending of damaged files: never read again, may be deleted."""


class ResultCache:
    """A directory of result files that processes may share: each appears complete, its digest in its name."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory

    @contextmanager
    def incoming(self) -> Iterator[BinaryIO]:
        """Yield a file to write a result into; it is removed afterwards unless it was kept.

        Raises `BadInput`: the directory cannot be written.
        """
        with self._part(self._directory) as stream:
            yield stream

    def keep(self, kind: str, key: str, stream: BinaryIO, digest: str, suffix: str = SUFFIX) -> Path:
        """Keep the file of `incoming`; `digest` is its SHA-256, hexadecimal."""
        file = self._folder(kind, key) / f"{digest}{suffix}"
        file.parent.mkdir(parents=True, exist_ok=True)
        _settle(stream, file)
        return file

    def get(self, kind: str, key: str, suffix: str = SUFFIX) -> Path | None:
        """Return a file of a result if it is here and undamaged; a damaged one is set aside."""
        for file in sorted(self._folder(kind, key).glob(f"*{suffix}")):
            if _holds(file, file.stem):
                with contextlib.suppress(OSError):  # of another owner
                    os.utime(file)  # its last use, by which caches are kept small
                return file
        return None

    def remember(
        self, service: str, process: str, inputs: dict[str, Any], result: Result, version: str = ""
    ) -> None:
        """Record the result of these inputs; `version` is the service's, if it is known."""
        file = self._note(service, process, inputs)
        with self._part(file.parent) as stream:
            stream.write(json.dumps(asdict(result) | {"version": version}).encode())
            _settle(stream, file)

    def recall(
        self, service: str, process: str, inputs: dict[str, Any], version: str | None = None
    ) -> Result | None:
        """Return the earlier result of these inputs, if its file is here and undamaged.

        If a version is given, only a result of a service of that version.
        """
        try:
            note = json.loads(self._note(service, process, inputs).read_text())
            result = Result(str(note["key"]), str(note["kind"]), str(note["href"]))
            if version not in (None, note.get("version")):
                return None
        except (OSError, ValueError, KeyError, TypeError):
            return None
        is_stored = any(self.get(result.kind, result.key, suffix) is not None for suffix in (SUFFIX, FIGURES))
        return result if is_stored else None

    def _folder(self, kind: str, key: str) -> Path:
        """Return the folder of a key; it has several files if services gave different bytes for the key.

        A key is hashed again unless it is a plain hash.
        """
        plain = len(key) == 64 and set(key) <= set("0123456789abcdef")
        name = key if plain else hashlib.sha256(key.encode("utf-8", "replace")).hexdigest()
        return self._directory / kind / name

    def _note(self, service: str, process: str, inputs: dict[str, Any]) -> Path:
        text = json.dumps({"service": service, "process": process, "inputs": inputs}, sort_keys=True)
        return self._directory / "requests" / f"{hashlib.sha256(text.encode()).hexdigest()}.json"

    @contextmanager
    def _part(self, folder: Path) -> Iterator[BinaryIO]:
        """Yield a file in a folder that nobody else sees or writes."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=folder, prefix=".", suffix=".part", delete=False) as stream:
                try:
                    yield cast("BinaryIO", stream)
                finally:
                    Path(stream.name).unlink(missing_ok=True)
        except OSError as error:
            bound, remedy = "a folder that can be written", "Give cache_dir, or set XDG_CACHE_HOME."
            raise BadInput.of(
                "cache_dir", str(self._directory), bound, f"{error.strerror}. {remedy}"
            ) from None


def _holds(file: Path, digest: str) -> bool:
    """Whether the digest of a file is right; a file with another one is set aside."""
    try:
        with file.open("rb") as stream:
            actual = hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:  # unreadable, or set aside by another process: as good as not here
        return False
    if actual != digest:
        with contextlib.suppress(OSError):
            file.replace(f"{file}{SET_ASIDE}")
    return actual == digest


def _settle(stream: BinaryIO, file: Path) -> None:
    """Give a written file its name: a reader sees all of the file, or nothing.

    What a power failure cuts short is found damaged when it is read, so the disk is not waited for.
    """
    stream.flush()
    Path(stream.name).replace(file)
