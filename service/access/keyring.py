"""Who sends a request; the keyring and its file: names, hashes, rights and limits, never the keys themselves.

A key has 256 random bits: nobody guesses it as one would a password, so that one round of SHA-256 is enough.
Two keys have the same name while one takes the place of the other.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import os
import re
import secrets
import tempfile
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime, timedelta
from enum import StrEnum
from pathlib import Path
from threading import Lock
from typing import Any

import structlog

from lineofaction.gearbox.problems import BadInput
from service.project import COMMON, PROJECT

# How long a key is good: durations as they are written on the command line, instants as they are kept.


SOON = timedelta(days=7)
"""A key that ends within this is mentioned in the log."""

_DURATION = re.compile(r"([1-9][0-9]{0,4})([hdw])")
_UNITS = {"h": timedelta(hours=1), "d": timedelta(days=1), "w": timedelta(weeks=1)}
LIMITS = (
    "requests_per_minute",
    "unfinished_jobs",
    "highest_priority",
    "max_cost_s",
    "connections",
    "streams",
)
"""Fields of a holder that are limits."""
LEAST = {"highest_priority": -9}
"""Of limits; of others 1."""
PREFIX = "loa_"
"""Beginning of every key."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
logger = structlog.get_logger(__name__)
_DAY_S = 86_400.0
_Stamp = tuple[int, int, int] | None


def _duration(field: str, text: str) -> timedelta:
    """Return a duration such as 12h, 90d or 26w; raises `BadInput`."""
    parts = _DURATION.fullmatch(text)
    if parts is None:
        raise BadInput.of(field, text, "a number of hours, days or weeks", "For example: 12h, 90d, 26w")
    return int(parts[1]) * _UNITS[parts[2]]


def _written(instant: datetime) -> str:
    """Return an instant in UTC as RFC 3339, seconds."""
    return instant.astimezone(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")


def _instant_of(text: str) -> datetime:
    """Return an instant as `_written`; raises ValueError of what has no time zone."""
    instant = datetime.fromisoformat(text)
    if instant.tzinfo is None:
        raise ValueError(text)
    return instant


class Scope(StrEnum):
    """Something that a caller may do; none contains another."""

    READ = "read"
    SUBMIT = "submit"
    DISMISS = "dismiss"
    OPERATE = "operate"


MEANINGS = {
    Scope.READ: "see processes, jobs and results of the project, ask for plans and live answers",
    Scope.SUBMIT: "execute processes, name jobs of one's own",
    Scope.DISMISS: "dismiss jobs of one's own",
    Scope.OPERATE: "dismiss and name jobs of others in the project, read the metrics of the service",
}
EVERY_SCOPE = tuple(Scope)


@dataclass(frozen=True, kw_only=True)
class Holder:
    """A known caller."""

    name: str
    """Stands in the log and beside jobs."""
    project: str = COMMON
    """Whose jobs and results are seen."""
    scopes: tuple[Scope, ...] = EVERY_SCOPE
    expires: str | None = None
    """The instant from which the caller is refused, RFC 3339, UTC; None: none."""
    requests_per_minute: int | None = None
    """Beyond it requests are answered with 429; None: no limit."""
    unfinished_jobs: int | None = None
    """Jobs that may wait or run at the same time; None: no limit but the queue's."""
    highest_priority: int | None = None
    """That jobs may have, -9 to 9; None: any."""
    max_cost_s: int | None = None
    """CPU seconds that each job may take; None: no limit."""
    connections: int | None = None
    """Requests answered at the same time, and bodies under way; None: a share of the server's."""
    streams: int | None = None
    """Event streams open at the same time; None: no limit but the server's."""

    @property
    def limits(self) -> dict[str, int | None]:
        """The limits by their names."""
        return {name: getattr(self, name) for name in LIMITS}

    def ends_within(self, time: timedelta, now: datetime | None = None) -> bool:
        """Whether the caller's time ends in less than this, or is over."""
        return self.expires is not None and _instant_of(self.expires) <= (now or datetime.now(UTC)) + time

    @property
    def expired(self) -> bool:
        """Whether the caller's time is over."""
        return self.ends_within(timedelta(0))


# The record of an access key.


@dataclass(frozen=True, kw_only=True)
class AccessKey(Holder):
    """The record of a key, which names its holder."""

    sha256: str
    """Of the key, hexadecimal."""
    created: str
    """RFC 3339, UTC."""


def _record_of(entry: dict[str, Any]) -> AccessKey:
    """Return one entry; raise ValueError or TypeError if it is none, fields of other versions ignored."""
    known = {field.name: entry[field.name] for field in fields(AccessKey) if field.name in entry}
    if "scopes" in known:
        known["scopes"] = tuple(Scope(name) for name in known["scopes"])
    key = AccessKey(**known)
    if len(bytes.fromhex(key.sha256)) != hashlib.sha256().digest_size or not isinstance(key.name, str):
        raise ValueError(entry)
    if key.project != COMMON and PROJECT.fullmatch(key.project) is None:
        raise ValueError(entry)
    if key.expires is not None:
        _instant_of(key.expires)
    for name, limit in key.limits.items():
        if limit is not None and (not isinstance(limit, int) or limit < LEAST.get(name, 1)):
            raise ValueError(entry)
    return key


class KeyFile:
    """Access keys in a JSON file that only its owner reads."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> tuple[AccessKey, ...]:
        """Return the keys; none if there is no file.

        Raises `BadInput`: the file cannot be read, or is not one of keys.
        """
        try:
            entries = json.loads(self.path.read_text("utf-8"))["keys"]
            return tuple(_record_of(entry) for entry in entries)
        except FileNotFoundError:
            return ()
        except OSError as error:
            raise self._unusable(f"{error.strerror}.") from None
        except (ValueError, KeyError, TypeError):
            raise self._unusable("Write it with: loa keys add NAME") from None

    def add(self, name: str, *, expires: str | None = None, **rights: Any) -> str:
        """Enter a new key and return it: the only time that it is seen.

        Raises `BadInput`: the name is taken or no name, or a right is none.

        Parameters
        ----------
        expires : str, optional
            Duration for which it is good, such as ``90d``.
        **rights
            Other fields of `Holder`.
        """
        if _NAME.fullmatch(name) is None:
            bound = "1 to 64 letters, digits, dots, dashes or underscores, the first a letter or a digit"
            raise BadInput.of("name", name, bound, "For example: test-bench-3")
        known = self.read()
        if any(key.name == name for key in known):
            advice = f"Renew it with: loa keys rotate {name}; or take it back first: loa keys remove {name}"
            raise BadInput.of("name", name, "new", advice)
        holder = Holder(name=name, **_chosen(rights))
        secret, key = _made(holder, None if expires is None else _duration("expires", expires))
        self._write((*known, key))
        return secret

    def rotate(self, name: str, *, overlap: str = "0h", expires: str | None = None) -> str:
        """Enter another key of this name and return it; those there are end after `overlap`.

        Raises `BadInput`: there is no key of this name, or a duration is none.

        Parameters
        ----------
        overlap : str
            Duration for which the old key is good beside the new one; ``0h``: not at all.
        expires : str, optional
            Duration for which the new key is good; default: that for which the old one was made.
        """
        known = self.read()
        old = [key for key in known if key.name == name]
        if not old:
            raise _unknown(name, known)
        last, instant = old[-1], datetime.now(UTC)
        life = None if expires is None else _duration("expires", expires)
        if expires is None and last.expires is not None:
            life = _instant_of(last.expires) - _instant_of(last.created)
        holder = Holder(**{field.name: getattr(last, field.name) for field in fields(Holder)})
        secret, key = _made(holder, life)
        rest = timedelta(0) if overlap == "0h" else _duration("overlap", overlap)
        end, left = _written(instant + rest), [entry for entry in old if rest and not entry.expired]
        ending = [each if each.ends_within(rest, instant) else replace(each, expires=end) for each in left]
        self._write((*(entry for entry in known if entry.name != name), *ending, key))
        return secret

    def remove(self, name: str) -> None:
        """Take a key back, and any that it took the place of.

        Raises `BadInput`: there is none of this name.
        """
        known = self.read()
        left = tuple(key for key in known if key.name != name)
        if len(left) == len(known):
            raise _unknown(name, known)
        self._write(left)

    def _write(self, keys: tuple[AccessKey, ...]) -> None:
        """Put a whole new file in the place of the old one."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        # such a file is readable by its owner only
        descriptor, name = tempfile.mkstemp(dir=self.path.parent, prefix=".keys-")
        try:
            with os.fdopen(descriptor, "w", encoding="utf-8") as stream:
                json.dump({"keys": [asdict(key) for key in keys]}, stream, indent=2)
                stream.flush()
                os.fsync(stream.fileno())
            Path(name).replace(self.path)
        except OSError:
            Path(name).unlink(missing_ok=True)
            raise

    def _unusable(self, suggestion: str) -> BadInput:
        """Return the error of a file that gives no keys: never to be taken for one without keys."""
        return BadInput.of("keys_file", str(self.path), "a readable file of access keys", suggestion)


def _digest_of(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "surrogateescape")).hexdigest()


def _made(holder: Holder, life: timedelta | None) -> tuple[str, AccessKey]:
    secret, instant = PREFIX + secrets.token_urlsafe(32), datetime.now(UTC)
    expires = None if life is None else _written(instant + life)
    facts = vars(holder) | {"expires": expires}
    return secret, AccessKey(**facts, sha256=_digest_of(secret), created=_written(instant))


def _unknown(name: str, known: Iterable[AccessKey]) -> BadInput:
    names = ", ".join(dict.fromkeys(key.name for key in known)) or "none"
    return BadInput.of("name", name, f"one of the keys: {names}", "loa keys list shows them.")


def _chosen(rights: dict[str, Any]) -> dict[str, Any]:
    """Return rights as a holder has them; raise of what is none."""
    chosen = {name: value for name, value in rights.items() if value is not None}
    for field in LIMITS:
        least = LEAST.get(field, 1)
        if chosen.get(field, least) < least:
            raise BadInput.of(field, chosen[field], f"at least {least}", "Leave it out for no limit.")
    project = chosen.get("project", COMMON)
    if project != COMMON and PROJECT.fullmatch(project) is None:
        bound = "1 to 63 small letters, digits, dashes or underscores, the first a letter or a digit"
        raise BadInput.of("project", project, bound, "For example: axle-2")
    if "scopes" in chosen:
        chosen["scopes"] = _scopes(chosen["scopes"])
    return chosen


def _scopes(names: Iterable[str]) -> tuple[Scope, ...]:
    names = tuple(names)
    unknown = sorted(set(names) - set(Scope))
    if unknown or not names:
        bound = f"some of {', '.join(Scope)}"
        raise BadInput.of("scopes", ",".join(unknown), bound, "For example: read,submit,dismiss")
    return tuple(scope for scope in Scope if scope in names)


# Look-up of a presented key: in constant time, from a file that may change while the service runs.


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
        digest = _digest_of(presented)
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
                self._read_again(stamp)
        return self._keys

    def _read_again(self, stamp: _Stamp) -> None:
        """Take the file as it is now, unless it cannot be used."""
        try:
            self._keys = self._file.read()
        except BadInput as error:
            logger.warning("keys kept as they were", reason=str(error))
        self._stamp = stamp

    def _stamp_now(self) -> _Stamp:
        """Return what changes whenever the file does."""
        try:
            status = self._file.path.stat()
        except OSError:
            return None
        return status.st_mtime_ns, status.st_size, status.st_ino
