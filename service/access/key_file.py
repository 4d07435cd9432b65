"""The file of access keys: names, hashes, rights and limits, never the keys themselves."""

from __future__ import annotations

import hashlib
import json
import os
import re
import secrets
import tempfile
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput
from service.access.holder import LIMITS, Holder, Scope, instant_of
from service.project import COMMON, PROJECT

SOON = timedelta(days=7)
"""Time before the expiry of a key from which the log mentions the key."""
_DURATION = re.compile(r"([1-9][0-9]{0,4})([hdw])")
_UNITS = {"h": timedelta(hours=1), "d": timedelta(days=1), "w": timedelta(weeks=1)}
MIN = {"highest_priority": -9}
"""Least values of limits; the least value of a limit that is not listed is 1."""
PREFIX = "loa_"
"""Beginning of every key."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def _duration(field: str, text: str) -> timedelta:
    """Return a duration such as 12h, 90d or 26w; raises `BadInput`."""
    parts = _DURATION.fullmatch(text)
    if parts is None:
        raise BadInput.of(field, text, "a number of hours, days or weeks", "For example: 12h, 90d, 26w")
    return int(parts[1]) * _UNITS[parts[2]]


def _written(instant: datetime) -> str:
    """Return an instant in UTC as RFC 3339, seconds."""
    return instant.astimezone(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")


@dataclass(frozen=True, kw_only=True)
class AccessKey(Holder):
    """The record of a key, which names its holder."""

    sha256: str
    """SHA-256 of the key, hexadecimal."""
    created: str
    """Instant of creation, RFC 3339, UTC."""


def _record_of(entry: dict[str, Any]) -> AccessKey:
    """Return the key of an entry of the file, without fields of other versions.

    Raises `ValueError` or `TypeError`: the entry is not that of a key.
    """
    known = {field.name: entry[field.name] for field in fields(AccessKey) if field.name in entry}
    if "scopes" in known:
        known["scopes"] = tuple(Scope(name) for name in known["scopes"])
    key = AccessKey(**known)
    if len(bytes.fromhex(key.sha256)) != hashlib.sha256().digest_size or not isinstance(key.name, str):
        raise ValueError(entry)
    if key.project != COMMON and PROJECT.fullmatch(key.project) is None:
        raise ValueError(entry)
    if key.expires is not None:
        instant_of(key.expires)
    for name, limit in key.limits.items():
        if limit is not None and (not isinstance(limit, int) or limit < MIN.get(name, 1)):
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
        """Enter a new key and return it, which the file never shows again.

        Raises `BadInput`: the name is taken or not of the form of names, or a right is invalid.

        Parameters
        ----------
        expires : str, optional
            Duration for which the key is good, such as ``90d``.
        **rights
            Other fields of `Holder`.
        """
        if _NAME.fullmatch(name) is None:
            bound = "1 to 64 letters, digits, dots, dashes or underscores, the first a letter or a digit"
            raise BadInput.of("name", name, bound, "For example: test-bench-3")
        keys = self.read()
        if any(key.name == name for key in keys):
            remedy = f"Renew it with: loa keys rotate {name}; or take it back first: loa keys remove {name}"
            raise BadInput.of("name", name, "new", remedy)
        holder = Holder(name=name, **_chosen(rights))
        secret, key = _made(holder, None if expires is None else _duration("expires", expires))
        self._write((*keys, key))
        return secret

    def rotate(self, name: str, *, overlap: str = "0h", expires: str | None = None) -> str:
        """Enter another key of this name and return it; the present keys end after `overlap`.

        Raises `BadInput`: there is no key of this name, or a duration is invalid.

        Parameters
        ----------
        overlap : str
            Duration for which the old key is good beside the new one; ``0h``: not at all.
        expires : str, optional
            Duration for which the new key is good; default: the duration of the old one.
        """
        keys = self.read()
        old = [key for key in keys if key.name == name]
        if not old:
            raise _unknown(name, keys)
        last, instant = old[-1], datetime.now(UTC)
        life = None if expires is None else _duration("expires", expires)
        if expires is None and last.expires is not None:
            life = instant_of(last.expires) - instant_of(last.created)
        holder = Holder(**{field.name: getattr(last, field.name) for field in fields(Holder)})
        secret, key = _made(holder, life)
        common = timedelta(0) if overlap == "0h" else _duration("overlap", overlap)
        end, valid = _written(instant + common), [entry for entry in old if common and not entry.expired]
        ending = [  # old keys that end later now end with the overlap
            access_key if access_key.ends_within(common, instant) else replace(access_key, expires=end)
            for access_key in valid
        ]
        self._write((*(entry for entry in keys if entry.name != name), *ending, key))
        return secret

    def remove(self, name: str) -> None:
        """Remove all keys of a name: the last one, and those that it replaced.

        Raises `BadInput`: there is no key of this name.
        """
        keys = self.read()
        others = tuple(key for key in keys if key.name != name)
        if len(others) == len(keys):
            raise _unknown(name, keys)
        self._write(others)

    def _write(self, keys: tuple[AccessKey, ...]) -> None:
        """Put a whole new file in the place of the old one."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        # mkstemp makes a file that only its owner reads
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
        """Return the error of a file that cannot be read; it must never count as a file without keys."""
        return BadInput.of("keys_file", str(self.path), "a readable file of access keys", suggestion)


def _made(holder: Holder, life: timedelta | None) -> tuple[str, AccessKey]:
    """Return a new secret and its record, good for `life`; None: for ever."""
    secret, instant = PREFIX + secrets.token_urlsafe(32), datetime.now(UTC)
    expires = None if life is None else _written(instant + life)
    fields = vars(holder) | {"expires": expires}
    return secret, AccessKey(**fields, sha256=digest_of(secret), created=_written(instant))


def _unknown(name: str, keys: Iterable[AccessKey]) -> BadInput:
    names = ", ".join(dict.fromkeys(key.name for key in keys)) or "none"
    return BadInput.of("name", name, f"one of the keys: {names}", "loa keys list shows them.")


def _chosen(rights: dict[str, Any]) -> dict[str, Any]:
    """Return rights as a holder has them; raises `BadInput` for an invalid right."""
    chosen = {name: value for name, value in rights.items() if value is not None}
    for field in LIMITS:
        minimum = MIN.get(field, 1)
        if chosen.get(field, minimum) < minimum:
            raise BadInput.of(field, chosen[field], f"at least {minimum}", "Leave it out for no limit.")
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


def digest_of(secret: str) -> str:
    """Return the hash under which the file has a key."""
    return hashlib.sha256(secret.encode("utf-8", "surrogateescape")).hexdigest()
