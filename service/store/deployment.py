"""A deployment: one database and one store of files that belong together.

A deployment has a random identifier, which is in the database and in a note beside the files. Where the two
differ nothing is served and nothing is removed. The files are ours if the note has our database's identifier.
The place is the folder or bucket of the files; the index is the database's table of them. `WriteCheck` tries
whether both can be written.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import Column, Engine, String, Table, insert, select, update
from sqlalchemy.exc import SQLAlchemyError

from lineofaction.gearbox.problems import BadInput, NoSpace
from service.store.database import metadata, now, reading, redacted_url, writing
from service.store.dialects import dialect_of
from service.store.files import ResultName
from service.store.results import ResultStore
from service.store.retries import outage_of, retried
from service.store.shortages import shortage

NOTE = "deployment.json"
"""Name of the note in the folder of the files."""
_WRITTEN = "written"
"""Name of the file that is written to see whether writing is possible."""
_MOMENT_MS = 600
"""Time for which the trial write waits for another writer, ms."""
NOTES = (NOTE, _WRITTEN)
"""Names of files in the store that belong to no result."""

deployments = Table(
    "deployment",
    metadata,
    Column("id", String, primary_key=True),
    Column("created", String, nullable=False),
    Column("checked", String),
)
_REINDEX = (
    "If the database of these files is lost, run loa store reindex: it rebuilds the index from them. If it "
    "is not, name that database (LOA_DATABASE_URL, LOA_DATA_DIRECTORY), or another place for the results of "
    "this one (LOA_RESULTS_URL): two deployments on one place would remove each other's files."
)
_OTHER_STORE = (
    "Name the database of these files (LOA_DATABASE_URL, LOA_DATA_DIRECTORY), or the place of the results "
    "that this one names (LOA_RESULTS_URL)."
)
_WRITABLE = "Give the service the right to write there, or name another place (LOA_RESULTS_URL)."


@dataclass(frozen=True)
class _Owner:
    """The content of a note: a deployment's identifier, and its database when the note was written."""

    deployment: str
    database: str

    @classmethod
    def of(cls, text: str) -> _Owner:
        """Read a note; an unreadable note has an identifier that is no deployment's."""
        try:
            document = json.loads(text)
            return cls(str(document["deployment"]), str(document["database"]))
        except (ValueError, TypeError, KeyError):
            return cls("unknown", f"{NOTE} cannot be read")

    def __str__(self) -> str:
        return f"deployment {self.deployment} (database {self.database})"


class Deployment:
    """A database and the place of its results.

    `store`: its index, and the files.
    """

    def __init__(self, engine: Engine, store: ResultStore) -> None:
        self._engine, self._store, self._files = engine, store, store.files

    @retried
    def identifier(self) -> str | None:
        """Return the identifier in the database, None if it has none yet."""
        with reading(self._engine) as connection:
            return connection.execute(select(deployments.c.id)).scalar()

    def _named(self) -> str:
        """Return the identifier in the database, which gets one now if it has none."""
        return self.identifier() or self._name()

    @retried
    def _name(self) -> str:
        """Give the database an identifier, unless it has one, and return it."""
        with writing(self._engine, in_turn=True) as connection:
            known: str | None = connection.execute(select(deployments.c.id)).scalar()
            if known is None:
                known = uuid.uuid4().hex
                connection.execute(insert(deployments).values(id=known, created=now()))
            return known

    def confirm_files(self) -> None:
        """Confirm that the files belong to the database; write the note in a place without one.

        A new place has no note, and one of older versions of the program.

        Raises `BadInput`: the files are another deployment's; or there are files and the index is empty, or
        names none of them; or the index names files and the place is empty.
        """
        if self._owner() is None:
            self._comparison().refuse_strangers(self._refusal)
            self._mark()
        self.confirm()

    def confirm(self) -> None:
        """Confirm that the place is ours: at the start, and right before anything is removed.

        Raises `BadInput`: the note beside the files names another deployment, or is gone.
        """
        owner = self._owner()
        if owner is None or owner.deployment != self._named():
            whose = f"to {owner}" if owner is not None else f"to nobody: its {NOTE} is gone"
            tip = _REINDEX if self._comparison().may_be_ours else _OTHER_STORE
            raise self._refusal(f": it belongs {whose}", tip)

    def write_database(self) -> None:
        """Write to the database as a trial, before writers of submissions that wait.

        Raises `DatabaseUnavailable`: it does not answer, is damaged, or another writer has it locked for more
        than `_MOMENT_MS`. `NoSpace`: its disk has no room for a submission.
        """
        _refuse_without_space(dialect_of(self._engine).folder(self._engine.url))
        try:
            with writing(self._engine, in_turn=True, patience_ms=_MOMENT_MS, ahead=True) as connection:
                connection.execute(update(deployments).values(checked=now()))
        except SQLAlchemyError as error:
            raise outage_of(error, self._engine) or error from error

    def write_results(self) -> None:
        """Write to the place of results as a trial.

        Raises
        ------
        BadInput
            The place is no longer ours, or cannot be written.
        StoreUnavailable
            It does not answer.
        NoSpace
            Its disk is full.
        """
        _refuse_without_space(self._files.folder)
        self.confirm()
        self._put(_WRITTEN, now(), replace=True)

    def take_over(self) -> None:
        """Make the files ours; a former owner removes none of them any more.

        Raises `BadInput`: they are another's, and the index names other files.
        """
        if self._owner() is None or self._comparison().may_be_ours:
            self._mark(replace=True)
        self.confirm()

    def _owner(self) -> _Owner | None:
        text = self._files.note(NOTE)
        return None if text is None else _Owner.of(text)

    def _mark(self, *, replace: bool = False) -> None:
        """Write the note; of several deployments that do so at the same time, the first one's stays."""
        note = {"deployment": self._named(), "database": redacted_url(self._engine), "since": now()}
        self._put(NOTE, json.dumps(note, indent=1) + "\n", replace=replace)

    def _put(self, name: str, text: str, *, replace: bool) -> None:
        """Write a note; raises `BadInput` if the place cannot be written."""
        try:
            self._files.put_note(name, text, replace=replace)
        except OSError as error:
            raise self._refusal(f", where we may write: {error.strerror}", _WRITABLE) from None

    def _comparison(self) -> _Comparison:
        named = {line.file for line in self._store.lines()}
        first = None
        for file in self._files.files():
            if file.name in named:
                return _Comparison(len(named), file.name, known=True)
            if first is None and ResultName.of(file.name) is not None:
                first = file.name
        return _Comparison(len(named), first, known=False)

    def _refusal(self, bound: str, tip: str) -> BadInput:
        ours = f"the place of deployment {self._named()} (database {redacted_url(self._engine)})"
        return BadInput.of("results", self._files.address, ours + bound, tip)


def _refuse_without_space(folder: Path | None) -> None:
    if fault := shortage(folder):
        raise NoSpace(fault)


@dataclass(frozen=True)
class _Comparison:
    """Comparison of an index with the files in the place."""

    named: int
    """Number of files that the index names."""
    file: str | None
    """A result's file in the place, if possible one that the index names; None: there is none."""
    known: bool
    """Whether the index names `file`."""

    @property
    def may_be_ours(self) -> bool:
        """Whether the files may be those of the index: it is empty, or names one of them."""
        return self.named == 0 or self.known

    def refuse_strangers(self, refusal: Callable[[str, str], BadInput]) -> None:
        """Raise a refusal if files without a note cannot be those of the index."""
        if self.known or (self.named == 0 and self.file is None):
            return
        if self.file is None:
            tip = "Is its volume mounted? If they are lost, loa store reindex removes them from the index."
            raise refusal(f", whose index names {self.named} files: none of them is there", tip)
        index = "names other files" if self.named else "is empty"
        bound = f": there are files (such as {self.file}) and the index {index}"
        raise refusal(bound, _OTHER_STORE if self.named else _REINDEX)
