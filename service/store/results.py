"""The store of results: named by the hash of their input, verified by the digest of their contents."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple

from sqlalchemy import (
    BigInteger,
    Column,
    ColumnElement,
    Connection,
    Engine,
    Index,
    Row,
    String,
    Table,
    Text,
    delete,
    select,
    tuple_,
    update,
)

from fe_contact.cache_reads import CacheReads
from lineofaction.gearbox.problems import DamagedFile, NotFound
from service.project import COMMON, address_of, at_address
from service.store.database import BRIEF_MS, instant, metadata, now, reading, writing
from service.store.dialects import dialect_of
from service.store.files import SET_ASIDE, ResultFiles, WrongContent, digest_of, new_name
from service.store.retries import optional, retried

USE_NOTED_EVERY_S = 3600.0
"""Seconds between two notes of the use of a result that is read all the time."""
results = Table(
    "result",
    metadata,
    Column("key", String, primary_key=True),
    Column("kind", String, primary_key=True),
    Column("sha256", String, nullable=False),
    Column("size", BigInteger, nullable=False),
    Column("created", String, nullable=False),
    Column("file", String, nullable=False, default=""),
    Column("used", String, nullable=False, default=""),
    Column("reindexed", String),
    Column("project", String, nullable=False, default=""),
    Column("headline", Text, nullable=False, default=""),
)


class Mark(NamedTuple):
    """The last line of a page. The next page begins behind it, even if the line was removed since."""

    created: str
    """RFC 3339 in UTC with microseconds."""
    name: str
    """Identifier, which orders lines of one instant."""


def behind(mark: Mark, created: ColumnElement[Any], name: ColumnElement[Any]) -> ColumnElement[bool]:
    """Return the condition of lines older than the mark."""
    return tuple_(created, name) < tuple_(mark.created, mark.name)


Index("result_by_use", results.c.used)
Index("result_by_project", results.c.project, results.c.kind, results.c.created)


@dataclass(frozen=True)
class IndexLine:
    """A line of the index: one result."""

    key: str
    """Hash of the input: the resource's name."""
    kind: str
    """Kind of the result, one of `lineofaction.gearbox.registry`."""
    sha256: str
    """Digest of the file's bytes, hexadecimal."""
    size: int
    """Bytes."""
    file: str
    """Name of the file in its place."""
    used: str
    """Time of the last request for the result, exact to an hour."""
    reindexed: str | None = None
    """Time at which the line was rebuilt from its file: the result is as old as that, or older."""
    project: str = COMMON
    """Project of the result."""
    headline: str = ""
    """Headline of the result in a list of jobs, JSON; empty: none."""

    @property
    def address(self) -> str:
        """The key of the line in the index."""
        return address_of(self.project, self.key)


@dataclass(frozen=True)
class StoredResult:
    """A result whose bytes were compared with its digest."""

    key: str
    kind: str
    sha256: str
    size: int
    """`key`, `kind`, `sha256`, `size`: Fields of the line in the index."""
    path: Path
    """The file on this machine."""


class ResultStore:
    """Store of results, written once and verified on reading: the first result of a key stays.

    Parameters
    ----------
    engine : Engine
        Database of the index.
    files : ResultFiles
        Place of the files.
    project : str
        Project whose results are put, found, read and listed here. Upkeep (`lines`, `enter`, `strike`,
        `set_aside`) covers all projects.

    Attributes
    ----------
    lookups : CacheReads
        Number of results that `find` sought, as for submissions, and number found.
    """

    def __init__(self, engine: Engine, files: ResultFiles, project: str = COMMON) -> None:
        self._engine, self.files, self.project = engine, files, project
        self._noted: dict[tuple[str, str], float] = {}
        self.lookups = CacheReads()

    def within(self, project: str) -> ResultStore:
        """Return the store of another project."""
        if project == self.project:
            return self
        other = ResultStore(self._engine, self.files, project)
        other.lookups = self.lookups
        return other

    def put(self, key: str, kind: str, file: Path, headline: Mapping[str, Any] | None = None) -> IndexLine:
        """Take `file` into the store: first the bytes, then the index; may be repeated if it failed."""
        known = self._intact(key, kind)
        if known is None:
            known = self._put(key, kind, file, json.dumps(headline) if headline else "")
        else:
            self._note_use(key, kind)
        file.unlink(missing_ok=True)
        return known

    def _put(self, key: str, kind: str, file: Path, headline: str = "") -> IndexLine:
        """Place the file under a name of its own, and enter it if nobody was quicker."""
        sha256 = digest_of(file)
        name = new_name(self.project, key, kind, sha256)
        size, named = file.stat().st_size, {"project": self.project, "headline": headline}
        line = IndexLine(key, kind, sha256, size, name, now(), **named)
        self.files.put(name, file, sha256)
        entered = self.enter(line)
        if entered.file != name:
            self.files.delete(name)
        return entered

    @retried
    def enter(self, line: IndexLine, *, made: str | None = None) -> IndexLine:
        """Enter a result unless one with a file is stored; return the stored one.

        With `made`, the date of its file, it is marked as entered anew: by `service.store.maintenance`.
        """
        with writing(self._engine, in_turn=True) as connection:
            before = _line(connection, line.address, line.kind)
            if before is not None and (before.file == line.file or self.files.has(before.file)):
                return before
            values = {"sha256": line.sha256, "size": line.size, "file": line.file, "used": line.used}
            values["headline"] = line.headline
            values["reindexed"] = None if made is None else line.used
            insert = dialect_of(connection).insert(results)
            named = {"key": line.address, "kind": line.kind, "project": line.project}
            statement = insert.values(**named, created=made or line.used, **values)
            connection.execute(statement.on_conflict_do_update(index_elements=["key", "kind"], set_=values))
        return line

    def find(self, key: str, kind: str) -> IndexLine | None:
        """Return the index's line, None if there is none or its file is gone."""
        if not _is_key(key):
            return None
        line = self._intact(key, kind)
        self.lookups.note(hit=line is not None)
        return line

    def holds(self, key: str, kind: str) -> bool:
        """Return whether a result is stored; the look is no use of the result."""
        return self._intact(key, kind) is not None

    def _intact(self, key: str, kind: str) -> IndexLine | None:
        line = self._find(key, kind)
        return line if line is not None and self.files.has(line.file) else None

    @retried
    def _find(self, key: str, kind: str | None) -> IndexLine | None:
        """Return the index's line of a key; its only one, if no kind is named."""
        with reading(self._engine) as connection:
            return _line(connection, address_of(self.project, key), kind)

    @retried
    def page(self, kind: str, limit: int, after: Mark | None = None) -> list[tuple[Mark, IndexLine]]:
        """Return up to `limit` lines of a kind behind `after` with their places, the newest first."""
        statement = select(results).where(results.c.project == self.project, results.c.kind == kind)
        if after is not None:
            last = Mark(after.created, address_of(self.project, after.name))
            statement = statement.where(behind(last, results.c.created, results.c.key))
        ordered = statement.order_by(results.c.created.desc(), results.c.key.desc()).limit(limit)
        with reading(self._engine) as connection:
            rows = connection.execute(ordered).all()
        return [(Mark(row.created, at_address(row.key)[1]), _index_line(row)) for row in rows]

    def verified(self, key: str, kind: str | None = None) -> StoredResult:
        """Return the result of a key after comparing its bytes with its digest; without `kind`, of any kind.

        Raises
        ------
        NotFound
            No such result.
        DamagedFile
            The bytes changed; the file is set aside, so that a new job computes it again.
        StoreUnavailable, DatabaseUnavailable
            Its place, or the index, does not answer.
        """
        line = self._find(key, kind) if _is_key(key) else None
        if line is None:
            raise self._missing(key, kind)
        try:
            path = self.files.local(line.file, line.sha256)
        except FileNotFoundError:
            raise self._missing(key, kind) from None
        except WrongContent:
            self.set_aside(line)
            text = f"The file of {line.kind} {key} was damaged and is set aside. Submit its case again."
            raise DamagedFile(text) from None
        self.note_use(key, line.kind)
        return StoredResult(key, line.kind, line.sha256, line.size, path)

    @staticmethod
    def _missing(key: str, kind: str | None) -> NotFound:
        return NotFound(f"There is no {kind or 'result'} {key!r}. Submit its case again to compute it.")

    def note_use(self, key: str, kind: str) -> None:
        """Note that a result was requested; cheap, and written once an hour."""
        last = self._noted.get((key, kind), -USE_NOTED_EVERY_S)  # long ago by a clock that begins at 0
        if time.monotonic() - last >= USE_NOTED_EVERY_S:
            self._note_use(key, kind)

    @optional
    def _note_use(self, key: str, kind: str) -> None:
        """Write down that a result was requested; nobody waits for that."""
        conditions = (results.c.key == address_of(self.project, key), results.c.kind == kind)
        before = instant(datetime.now(UTC) - timedelta(seconds=USE_NOTED_EVERY_S))
        with writing(self._engine, patience_ms=BRIEF_MS) as connection:
            connection.execute(update(results).where(*conditions, results.c.used < before).values(used=now()))
        self._noted[(key, kind)] = time.monotonic()

    @retried
    def without_headline(self, keys: Collection[str], kind: str, limit: int) -> list[IndexLine]:
        """Return up to `limit` lines of these keys that never got a headline, not even an empty one."""
        addresses = [address_of(self.project, key) for key in keys]
        conditions = results.c.key.in_(addresses), results.c.kind == kind, results.c.headline == ""
        with reading(self._engine) as connection:
            rows = connection.execute(
                select(results).where(*conditions).order_by(results.c.key).limit(limit)
            ).all()
        return [_index_line(row) for row in rows]

    @optional
    def note_headline(self, key: str, kind: str, headline: Mapping[str, Any]) -> None:
        """Store the headline of a result that was stored without; empty: it has none."""
        conditions = results.c.key == address_of(self.project, key), results.c.kind == kind
        step = (
            update(results).where(*conditions, results.c.headline == "").values(headline=json.dumps(headline))
        )
        with writing(self._engine, patience_ms=BRIEF_MS) as connection:
            connection.execute(step)

    def set_aside(self, line: IndexLine) -> None:
        """Take a damaged file out of service."""
        self.strike(line)
        self.files.move(line.file, line.file + SET_ASIDE)

    @retried
    def strike(self, line: IndexLine, *, unused_since: str | None = None) -> bool:
        """Remove a line from the index, if it still names the same file and was not used since an instant.

        Return whether it was removed.
        """
        conditions = [results.c.key == line.address, results.c.kind == line.kind, results.c.file == line.file]
        if unused_since is not None:
            conditions.append(results.c.used < unused_since)
        with writing(self._engine) as connection:
            return connection.execute(delete(results).where(*conditions)).rowcount > 0

    @retried
    def lines(self) -> list[IndexLine]:
        """Return the whole index."""
        with reading(self._engine) as connection:
            rows = connection.execute(select(results).order_by(results.c.key, results.c.kind)).all()
        return [_index_line(row) for row in rows]


def _is_key(key: str) -> bool:
    return len(key) == hashlib.sha256().digest_size * 2 and set(key) <= set("0123456789abcdef")


def _line(connection: Connection, address: str, kind: str | None) -> IndexLine | None:
    statement = select(results).where(results.c.key == address).order_by(results.c.kind)
    if kind is not None:
        statement = statement.where(results.c.kind == kind)
    row = connection.execute(statement).first()
    return None if row is None else _index_line(row)


def _index_line(row: Row[Any]) -> IndexLine:
    project, key = at_address(row.key)
    fields = (row.kind, row.sha256, row.size, row.file, row.used, row.reindexed)
    return IndexLine(key, *fields, project=project, headline=row.headline)
