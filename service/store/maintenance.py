"""Checks of the store against its files, and the quarantine of files without an entry."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from service.store.database import instant
from service.store.deployment import NOTES, Deployment
from service.store.files import PARTIAL, SET_ASIDE, KeptFile, ResultFiles
from service.store.results import IndexLine, ResultStore

_FOLDER = "quarantine/"
_INSTANT = "%Y%m%dT%H%M%SZ"
GRACE_S = 3600.0
"""A file that young may belong to a result that is about to be entered."""


class Quarantine:
    """The way out of a store.

    Parameters
    ----------
    deployment : Deployment
        Asked before each step: what is another's stays.
    days : float
        Number of days for which a file stays.
    """

    def __init__(self, files: ResultFiles, deployment: Deployment, days: float) -> None:
        self._files, self._deployment, self.days = files, deployment, days

    def confirm(self) -> None:
        """Raise `BadInput` if the files are no longer ours."""
        self._deployment.confirm()

    def admit(self, name: str) -> None:
        """Move a file here; raises `BadInput` if it is no longer ours."""
        self.confirm()
        self._files.move(name, f"{_FOLDER}{name}.{datetime.now(UTC).strftime(_INSTANT)}")

    def release(self) -> int:
        """Move every file back where it came from; return their number."""
        quarantined = [file for file in self._files.files() if is_quarantined(file.name)]
        for file in quarantined:
            self.confirm()
            self._files.move(file.name, file.name.removeprefix(_FOLDER).rpartition(".")[0])
        return len(quarantined)

    def purge(self, *, dry_run: bool) -> Iterator[KeptFile]:
        """Remove for good the files that have been here for long enough; files without a date stay."""
        before = datetime.now(UTC) - timedelta(days=self.days)
        for file in list(self._files.files()):
            since = _admitted(file.name)
            if since is not None and since <= before:
                if not dry_run:
                    self.confirm()
                    self._files.delete(file.name)
                yield file


def is_quarantined(name: str) -> bool:
    """Whether a file is on its way out."""
    return name.startswith(_FOLDER)


def _admitted(name: str) -> datetime | None:
    """Return when a file came into quarantine; None if it is not there, or does not say."""
    if not is_quarantined(name):
        return None
    try:
        return datetime.strptime(name.rpartition(".")[2], _INSTANT).replace(tzinfo=UTC)
    except ValueError:
        return None


@dataclass(frozen=True)
class Verified:
    """The state of the files of the index."""

    sound: int
    """Files that have their digest."""
    damaged: tuple[str, ...]
    missing: tuple[str, ...]
    """`damaged`, `missing`: Names of files with other bytes, which are set aside, and of missing files."""
    unknown: tuple[str, ...] = ()
    """Names of files that the index does not name. Retention never removes them."""
    quarantined: int = 0
    reindexed: int = 0
    """`quarantined`, `reindexed`: Files on their way out; lines rebuilt from files, whose retention counts
    from then.
    """


def verify_store(store: ResultStore) -> Verified:
    """Read every file of the index and compare it with its digest; set differing files aside.

    A result that is expired while this runs counts as neither.
    """
    sound, damaged, missing = 0, [], []
    # the files first, then the index: what is entered meanwhile is in the index
    files = list(store.files.files())
    lines = store.lines()
    for line in lines:
        try:
            if store.files.digest(line.file) == line.sha256:
                sound += 1
            else:
                store.set_aside(line)
                damaged.append(line.file)
        except FileNotFoundError:
            if line in store.lines():
                missing.append(line.file)
    named = {line.file for line in lines}
    unknown = tuple(file.name for file in files if file.name not in named and _is_ours(file.name))
    quarantined = sum(is_quarantined(file.name) for file in files)
    reindexed = sum(line.reindexed is not None for line in lines)
    return Verified(sound, tuple(damaged), tuple(missing), unknown, quarantined, reindexed)


@dataclass(frozen=True)
class Leftover:
    """Something that nobody needs: why, its name, its bytes, and whether it stays in quarantine."""

    why: str
    name: str
    size: int
    quarantined: bool = False


def expire_results(
    store: ResultStore, quarantine: Quarantine, older_than_days: float, *, dry_run: bool
) -> Iterator[Leftover]:
    """Move results without requests for a number of days out of the index, into quarantine.

    Only what the index dates goes. A line goes before its file, so that nothing is found whose file is gone;
    it goes only if it is still as it was seen, so that what is requested just now stays.
    """
    since = days_ago(older_than_days)
    for line in store.lines():
        if line.used < since and (dry_run or _expire(store, quarantine, line, since)):
            yield Leftover("not asked for", line.file, line.size, quarantined=True)


def _expire(store: ResultStore, quarantine: Quarantine, line: IndexLine, since: str) -> bool:
    """Take a result out, unless it was requested meanwhile."""
    quarantine.confirm()
    if not store.strike(line, unused_since=since):
        return False
    quarantine.admit(line.file)
    return True


def collect_orphans(store: ResultStore, quarantine: Quarantine, *, dry_run: bool) -> Iterator[Leftover]:
    """Strike lines whose file is gone, and take to quarantine the files that no line names."""
    quarantine.confirm()
    for line in store.lines():
        if not store.files.has(line.file) and (dry_run or store.strike(line)):
            yield Leftover("no file", line.file, 0)
    for file in _orphans(store):
        if not dry_run:
            quarantine.admit(file.name)
        why = "damaged" if file.name.endswith(SET_ASIDE) else "not in the index"
        why = "half written" if file.name.endswith(PARTIAL) else why
        yield Leftover(why, file.name, file.size, quarantined=True)


def _orphans(store: ResultStore) -> list[KeptFile]:
    """Return the files that no line names, but for quite new ones."""
    files = list(store.files.files())
    named = {line.file for line in store.lines()}
    return [
        file
        for file in files
        if _is_ours(file.name) and file.name not in named and time.time() - file.modified >= GRACE_S
    ]


def _is_ours(name: str) -> bool:
    """Whether the index should name a file: it is no note, and not in quarantine."""
    return name not in NOTES and not is_quarantined(name)


def purge_quarantine(quarantine: Quarantine, *, dry_run: bool) -> Iterator[Leftover]:
    """Remove for good the files that have been in quarantine for long enough."""
    for file in quarantine.purge(dry_run=dry_run):
        yield Leftover("quarantine ended", file.name, file.size)


def days_ago(days: float) -> str:
    """Return the instant so many days ago."""
    return instant(datetime.now(UTC) - timedelta(days=days))
