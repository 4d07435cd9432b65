"""The quarantine of files before they are removed for good: each names the instant it came."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

from service.store.deployment import Deployment
from service.store.files import KeptFile, ResultFiles

_FOLDER = "quarantine/"
_INSTANT = "%Y%m%dT%H%M%SZ"


class Quarantine:
    """The way out of a store.

    Parameters
    ----------
    files : ResultFiles
    deployment : Deployment
        Asked before each step: what is another's stays.
    days : float
        How long a file stays.
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
        held = [file for file in self._files.files() if is_quarantined(file.name)]
        for file in held:
            self.confirm()
            self._files.move(file.name, file.name.removeprefix(_FOLDER).rpartition(".")[0])
        return len(held)

    def purge(self, *, dry_run: bool) -> Iterator[KeptFile]:
        """Remove for good what has been here for long enough; what tells no date stays."""
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
