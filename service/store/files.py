"""The files of results: their names, and their storage."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from fe_contact.cache_reads import CacheReads
from lineofaction.gearbox.registry import SUFFIX
from service.project import COMMON, PROJECT, address_of

_DIGEST_LENGTH = 16
"""Digits of the SHA-256 in a file's name."""
# KIND/FOLDER/[PROJECT.]KEY[.DIGEST][.UNIQUE].ENDING; the folder is the first two digits of the key
_NAME = re.compile(
    rf"(?P<kind>[a-z_]+)/(?P<folder>[0-9a-f]{{2}})/(?:(?P<project>{PROJECT.pattern})\.)?"
    r"(?P<key>(?P=folder)[0-9a-f]{62})"
    rf"(?:\.(?P<digest>[0-9a-f]{{{_DIGEST_LENGTH}}}))?(?:\.[0-9a-f]{{8}})?\.[a-z]+"
)
SET_ASIDE = ".damaged"
"""Ending of damaged files: kept for a person to look at, never served."""
PARTIAL = ".part"
"""Ending of a file that is being written."""
_PRIVATE = 0o600
"""Permissions of files: the user of the service reads and writes, nobody else."""


@dataclass(frozen=True)
class ResultName:
    """The parts of the name of a result's file."""

    kind: str
    key: str
    """`kind`, `key`: Kind and hash of the result, the same as in the index."""
    digest: str
    """Beginning of the SHA-256 of its bytes; empty in names that older versions gave."""
    project: str = COMMON
    """Project of the result."""

    @classmethod
    def of(cls, file: str) -> ResultName | None:
        """Read the name of a file; None: it is not the name of a result."""
        parts = _NAME.fullmatch(file)
        if parts is None:
            return None
        return cls(parts["kind"], parts["key"], parts["digest"] or "", parts["project"] or COMMON)

    def agrees(self, sha256: str) -> bool:
        """Whether a file of this digest can have this name; one of an older version can have any."""
        return sha256.startswith(self.digest)


def new_name(project: str, key: str, kind: str, sha256: str) -> str:
    """Return the name of a new file, which no other has."""
    unique = uuid.uuid4().hex[:8]
    return f"{kind}/{key[:2]}/{address_of(project, key)}.{sha256[:_DIGEST_LENGTH]}.{unique}{SUFFIX}"


class WrongContent(Exception):
    """The bytes of a file differ from the stored bytes."""


@dataclass(frozen=True)
class KeptFile:
    """A stored file."""

    name: str
    size: int
    """Number of bytes."""
    modified: float
    """Time of the last change, s since 1970."""


class ResultFiles(Protocol):
    """A place for files by name. A file with a name is complete: nobody sees a file that is being written."""

    address: str
    """The folder, or the URL of the bucket and prefix."""
    folder: Path | None
    """The folder on this machine that is written to; None: the files are on another machine."""
    reads: CacheReads
    """Reads of the cache on this machine; a folder needs no cache."""

    def put(self, name: str, file: Path, sha256: str) -> None:
        """Keep the bytes of `file`, durably when this returns; `file` stays."""

    def has(self, name: str) -> bool:
        """Whether there is a file of this name."""

    def local(self, name: str, sha256: str) -> Path:
        """Return a path with the bytes of this digest, read and compared now.

        Raises `FileNotFoundError`: there is no file of this name; `WrongContent`: its bytes are others.
        """

    def digest(self, name: str) -> str:
        """Return the SHA-256 of the bytes in the place itself, not of a local copy.

        Raises `FileNotFoundError`: there is no file of this name.
        """

    def note(self, name: str) -> str | None:
        """Return the text of a note, None if there is none of this name."""

    def put_note(self, name: str, text: str, *, replace: bool = False) -> None:
        """Store a short text; unless it may `replace` another, the text of the first writer stays."""

    def move(self, name: str, target: str) -> None:
        """Rename a file; it may be gone already."""

    def delete(self, name: str) -> None:
        """Remove a file; it may be gone already."""

    def files(self) -> Iterator[KeptFile]:
        """Return all files: also set aside, quarantined or half-written ones, and notes."""


class DirectoryFiles:
    """Files in a directory; several processes may use it at once."""

    def __init__(self, directory: Path) -> None:
        self._directory, self.address = directory, str(directory)
        self.folder: Path | None = directory
        self.reads = CacheReads()

    def put(self, name: str, file: Path, sha256: str) -> None:
        """Link the file to its name, or copy it where that cannot be."""
        target = self._directory / name
        target.parent.mkdir(parents=True, exist_ok=True)
        install_file(file, target)

    def has(self, name: str) -> bool:
        """Whether there is a file of this name."""
        return (self._directory / name).is_file()

    def local(self, name: str, sha256: str) -> Path:
        """Return the file itself, its bytes compared; raises as `ResultFiles.local`."""
        path = self._directory / name
        if digest_of(path) != sha256:
            raise WrongContent
        return path

    def digest(self, name: str) -> str:
        """Read the file; raises as `ResultFiles.digest`."""
        return digest_of(self._directory / name)

    def note(self, name: str) -> str | None:
        """Read a note."""
        with contextlib.suppress(FileNotFoundError):
            return (self._directory / name).read_text(encoding="utf-8")
        return None

    def put_note(self, name: str, text: str, *, replace: bool = False) -> None:
        """Write a draft and give it the name, in one step."""
        self._directory.mkdir(parents=True, exist_ok=True)
        target = self._directory / name
        draft = target.with_name(f"{name}.{uuid.uuid4().hex[:8]}{PARTIAL}")
        try:
            draft.write_text(text, encoding="utf-8")
            draft.chmod(_PRIVATE)
            _sync(draft)
            if replace:
                draft.replace(target)
            else:
                _name_if_free(draft, target)
            _sync(self._directory)
        finally:
            draft.unlink(missing_ok=True)

    def move(self, name: str, target: str) -> None:
        """Rename."""
        path = self._directory / target
        path.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            (self._directory / name).replace(path)

    def delete(self, name: str) -> None:
        """Remove."""
        (self._directory / name).unlink(missing_ok=True)

    def files(self) -> Iterator[KeptFile]:
        """Walk through the directory."""
        for path in sorted(self._directory.rglob("*")):
            with contextlib.suppress(FileNotFoundError):  # removed meanwhile
                if path.is_file():
                    status = path.stat()
                    yield KeptFile(
                        path.relative_to(self._directory).as_posix(), status.st_size, status.st_mtime
                    )


def _name_if_free(draft: Path, target: Path) -> None:
    """Give a short file its name unless that is taken; where there are no links the text is copied."""
    try:
        os.link(draft, target)
    except FileExistsError:
        return
    except OSError:
        with contextlib.suppress(FileExistsError), target.open("x", encoding="utf-8") as stream:
            stream.write(draft.read_text(encoding="utf-8"))


def install_file(file: Path, target: Path) -> None:
    """Give a file a second name, after its bytes are on disk; on another file system a copy gets the name."""
    draft = target.with_name(f"{target.name}.{uuid.uuid4().hex[:8]}{PARTIAL}")
    try:
        os.link(file, draft)
    except OSError:
        shutil.copyfile(file, draft)
    draft.chmod(_PRIVATE)
    _sync(draft)
    os.utime(draft)  # the time of storing: a linked file may be old, and would soon be removed
    draft.replace(target)
    _sync(target.parent)


def digest_of(file: Path) -> str:
    """Return the SHA-256 of a file's bytes, hexadecimal."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
