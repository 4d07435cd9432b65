"""Result files named by the hash of their input, verified by the digest of their contents."""

from __future__ import annotations

import contextlib
import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import BigInteger, Column, Engine, String, Table, delete, select

from service.problems import DamagedFile, NotFound
from service.schemas.result_kinds import suffix_of
from service.store.database import metadata, now, open_database, reading, writing
from service.store.dialects import dialect_of
from service.store.outages import retried

DATABASE_FILE = "service.sqlite3"
RESULTS_DIRECTORY = "results"

results = Table(
    "result",
    metadata,
    Column("key", String, primary_key=True),
    Column("kind", String, primary_key=True),
    Column("sha256", String, nullable=False),
    Column("size", BigInteger, nullable=False),
    Column("created", String, nullable=False),
)


@dataclass(frozen=True)
class StoredResult:
    """One line of the index.

    Attributes
    ----------
    key : str
        Hash of the input: the resource's name.
    kind : str
        One of `service.schemas.result_kinds`.
    sha256 : str
        Digest of the file's bytes, hexadecimal.
    size : int
        Bytes.
    path : Path
        The file.
    """

    key: str
    kind: str
    sha256: str
    size: int
    path: Path


class ResultStore:
    """Write once, read verified."""

    def __init__(self, engine: Engine, directory: Path) -> None:
        self._engine = engine
        self._directory = directory

    def put(self, key: str, kind: str, file: Path) -> StoredResult:
        """Move `file` (on the same file system) into the store: first the bytes, then the index."""
        stored = StoredResult(key, kind, digest_of(file), file.stat().st_size, self._path(key, kind))
        stored.path.parent.mkdir(parents=True, exist_ok=True)
        _sync(file)
        file.replace(stored.path)
        _sync(stored.path.parent)
        self._enter(stored)
        return stored

    @retried
    def _enter(self, stored: StoredResult) -> None:
        """Enter a result into the index."""
        row = {"sha256": stored.sha256, "size": stored.size, "created": now()}
        statement = dialect_of(self._engine).insert(results).values(key=stored.key, kind=stored.kind, **row)
        with writing(self._engine) as connection:
            connection.execute(statement.on_conflict_do_update(index_elements=["key", "kind"], set_=row))

    @retried
    def find(self, key: str, kind: str) -> StoredResult | None:
        """Return the index's line, None if there is none or its file is gone."""
        if not _is_key(key):
            return None
        with reading(self._engine) as connection:
            statement = select(results).where(results.c.key == key, results.c.kind == kind)
            row = connection.execute(statement).one_or_none()
        path = self._path(key, kind)
        return StoredResult(key, kind, row.sha256, row.size, path) if row and path.is_file() else None

    def verified(self, key: str, kind: str) -> StoredResult:
        """Return the result after comparing its bytes with its digest.

        Raises
        ------
        NotFound
            No such result.
        DamagedFile
            The bytes changed; the file is set aside, so that a new job computes it again.
        """
        stored = self.find(key, kind)
        if stored is None:
            raise NotFound(f"There is no {kind} {key!r}. Submit its case again to compute it.")
        if digest_of(stored.path) != stored.sha256:
            self._set_aside(stored)
            raise DamagedFile(
                f"The file of {kind} {key} was damaged and is set aside. Submit its case again."
            )
        return stored

    @retried
    def _set_aside(self, stored: StoredResult) -> None:
        """Take a damaged file out of service."""
        with writing(self._engine) as connection:
            connection.execute(
                delete(results).where(results.c.key == stored.key, results.c.kind == stored.kind)
            )
        with contextlib.suppress(FileNotFoundError):  # another was quicker
            stored.path.replace(stored.path.with_suffix(".damaged"))

    def _path(self, key: str, kind: str) -> Path:
        """File of a key."""
        return self._directory / kind / key[:2] / f"{key}{suffix_of(kind)}"


def stored_results(data_directory: Path, database_url: str | None = None) -> ResultStore:
    """Return the store in a data directory, its index in that directory or in the database at a URL."""
    engine = open_database(database_url or data_directory / DATABASE_FILE, pooled=False)
    return ResultStore(engine, data_directory / RESULTS_DIRECTORY)


def _is_key(key: str) -> bool:
    """Whether `key` is a SHA-256 in hexadecimal."""
    return len(key) == hashlib.sha256().digest_size * 2 and set(key) <= set("0123456789abcdef")


def digest_of(file: Path) -> str:
    """Return the SHA-256 of a file's bytes, hexadecimal."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _sync(path: Path) -> None:
    """Force a file or a directory to disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
