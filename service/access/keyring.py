"""Look-up of a presented key: in constant time, from a file that may change while the service runs.

A key has 256 random bits: nobody guesses it as one would a password, so that one round of SHA-256 is enough.
Two keys have the same name while one takes the place of the other.
"""

from __future__ import annotations

import hmac
import time
from threading import Lock

import structlog

from lineofaction.gearbox.problems import BadInput
from service.access.key_file import SOON, AccessKey, KeyFile, digest_of

logger = structlog.get_logger(__name__)
_DAY_S = 86_400.0
_Stamp = tuple[int, int, int] | None


class Keyring:
    """The keys of a file, read again whenever the file changes.

    Raises `BadInput` at the start: the file cannot be used. Later that is logged, and the keys read last
    stay in force.
    """

    def __init__(self, file: KeyFile) -> None:
        self._file = file
        self._lock = Lock()
        self._warned: dict[str, float] = {}
        self._stamp = self._stamp_now()
        self._keys = file.read()

    def __bool__(self) -> bool:
        """Whether there is any key."""
        return bool(self._current())

    def holder(self, presented: str) -> AccessKey | None:
        """Return the key that was presented, None if it is none of ours.

        All keys are compared, each in constant time: how long the answer takes tells nothing about them.
        """
        digest = digest_of(presented)
        holder = None
        for key in self._current():
            if hmac.compare_digest(digest, key.sha256):
                holder = key
        self._warn_of(holder)
        return holder

    def _warn_of(self, key: AccessKey | None) -> None:
        """Log, once a day, that a key in use ends soon."""
        if key is None or key.expired or not key.ends_within(SOON):
            return
        if time.monotonic() - self._warned.get(key.sha256, -_DAY_S) >= _DAY_S:
            self._warned[key.sha256] = time.monotonic()
            logger.warning("key ends soon", key=key.name, expires=key.expires)

    def _current(self) -> tuple[AccessKey, ...]:
        stamp = self._stamp_now()
        if stamp != self._stamp:
            with self._lock:
                self._reload(stamp)
        return self._keys

    def _reload(self, stamp: _Stamp) -> None:
        """Take the file as it is now, unless it cannot be used."""
        try:
            self._keys = self._file.read()
        except BadInput as error:
            logger.warning("keys kept as they were", reason=str(error))
        self._stamp = stamp

    def _stamp_now(self) -> _Stamp:
        """Return a stamp of the file that changes whenever the file does."""
        try:
            status = self._file.path.stat()
        except OSError:
            return None
        return status.st_mtime_ns, status.st_size, status.st_ino
