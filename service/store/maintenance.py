"""Keeping the store in order beside a running service: verify, collect what nobody needs, expire."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from service.store.database import instant
from service.store.files import PARTIAL, SET_ASIDE, KeptFile, WrongContent
from service.store.results import IndexLine, ResultStore

GRACE_S = 3600.0
"""A file that young may belong to a result that is about to be entered."""


@dataclass(frozen=True)
class Verified:
    """What became of the files of the index.

    Attributes
    ----------
    sound : int
        Files that have their digest.
    damaged, missing : tuple of str
        Names of those that had other bytes, and are set aside; of those that are gone.
    """

    sound: int
    damaged: tuple[str, ...]
    missing: tuple[str, ...]


def verify_store(store: ResultStore) -> Verified:
    """Read every file of the index and compare it with its digest; set aside what differs.

    A result that is expired while this runs counts as neither.
    """
    sound, damaged, missing = 0, [], []
    for line in store.lines():
        try:
            store.files.compare(line.file, line.sha256)
            sound += 1
        except WrongContent:
            store.set_aside(line)
            damaged.append(line.file)
        except FileNotFoundError:
            if line in store.lines():
                missing.append(line.file)
    return Verified(sound, tuple(damaged), tuple(missing))


@dataclass(frozen=True)
class Leftover:
    """Something that nobody needs: why, its name, and its bytes."""

    why: str
    name: str
    size: int


def collect_results(
    store: ResultStore, older_than_days: float | None, *, dry_run: bool
) -> Iterator[Leftover]:
    """Remove files that no line names, lines whose file is gone, and results unused for so many days.

    A line goes before its file, so that nothing is found whose file is gone; it goes only if it is still as
    it was seen, so that what is asked for just now stays.
    """
    yield from _lines(store, older_than_days, dry_run=dry_run)
    # the files first, then the index: what is entered meanwhile is in the index
    files = list(store.files.files())
    named = {line.file for line in store.lines()}
    for file in files:
        why = _why_orphan(file, named)
        if why is not None:
            if not dry_run:
                store.files.delete(file.name)
            yield Leftover(why, file.name, file.size)


def _lines(store: ResultStore, older_than_days: float | None, *, dry_run: bool) -> Iterator[Leftover]:
    """Remove lines without file and expired results."""
    since = None if older_than_days is None else days_ago(older_than_days)
    for line in store.lines():
        if not store.files.has(line.file):
            if dry_run or store.strike(line):
                yield Leftover("no file", line.file, 0)
        elif since is not None and line.used < since and (dry_run or _expire(store, line, since)):
            yield Leftover("not asked for", line.file, line.size)


def _expire(store: ResultStore, line: IndexLine, since: str) -> bool:
    """Remove a result, unless it was asked for meanwhile."""
    if not store.strike(line, unused_since=since):
        return False
    store.files.delete(line.file)
    return True


def _why_orphan(file: KeptFile, named: set[str]) -> str | None:
    """Why a file may go, None if it may not; what was set aside is kept as long as anything young."""
    if file.name in named or time.time() - file.modified < GRACE_S:
        return None
    if file.name.endswith(PARTIAL):
        return "half written"
    return "damaged" if file.name.endswith(SET_ASIDE) else "not in the index"


def days_ago(days: float) -> str:
    """Return the instant so many days ago."""
    return instant(datetime.now(UTC) - timedelta(days=days))
