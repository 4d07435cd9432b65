"""The file of access keys: names, hashes and limits, never the keys themselves.

A key has 256 random bits: nobody guesses it as one would a password, so that one round of SHA-256 is enough.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import secrets
import tempfile
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from service.problems import BadInput

_PREFIX = "loa_"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_LIMITS = ("requests_per_minute", "unfinished_jobs", "highest_priority", "max_cost_s")
_LEAST = {"highest_priority": -9}
"""Of limits; of others 1."""
_FIELDS = {"name", "sha256", "created", *_LIMITS}


@dataclass(frozen=True)
class AccessKey:
    """The record of a key.

    Attributes
    ----------
    name : str
        Whose it is; stands in the log and beside jobs.
    sha256 : str
        Of the key, hexadecimal.
    created : str
        RFC 3339, UTC.
    requests_per_minute : int or None
        Beyond it requests are answered with 429; None: no limit.
    unfinished_jobs : int or None
        Jobs of this key that may wait or run at the same time; None: no limit but the queue's.
    highest_priority : int or None
        That jobs of this key may have, -9 to 9; None: any.
    max_cost_s : int or None
        CPU seconds that each job of this key may take; None: no limit.
    """

    name: str
    sha256: str
    created: str
    requests_per_minute: int | None = None
    unfinished_jobs: int | None = None
    highest_priority: int | None = None
    max_cost_s: int | None = None


class KeyFile:
    """Access keys in a JSON file that only its owner reads."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> tuple[AccessKey, ...]:
        """Return the keys; none if there is no file.

        Raises
        ------
        BadInput
            The file cannot be read, or is not one of keys.
        """
        try:
            entries = json.loads(self.path.read_text("utf-8"))["keys"]
            return tuple(_checked(entry) for entry in entries)
        except FileNotFoundError:
            return ()
        except OSError as error:
            raise self._unusable(f"{error.strerror}.") from None
        except (ValueError, KeyError, TypeError):
            raise self._unusable("Write it with: loa keys add NAME") from None

    def add(self, name: str, **limits: int | None) -> str:
        """Enter a new key and return it: the only time that it is seen.

        Raises
        ------
        BadInput
            The name is taken or no name, or a limit is below its least value.
        """
        if _NAME.fullmatch(name) is None:
            bound = "1 to 64 letters, digits, dots, dashes or underscores, the first a letter or a digit"
            raise BadInput.of("name", name, bound, "For example: test-bench-3")
        for field, limit in limits.items():
            least = _LEAST.get(field, 1)
            if limit is not None and limit < least:
                raise BadInput.of(field, limit, f"at least {least}", "Leave it out for no limit.")
        known = self.read()
        if any(key.name == name for key in known):
            raise BadInput.of("name", name, "new", f"Take the old key back first: loa keys remove {name}")
        secret = _PREFIX + secrets.token_urlsafe(32)
        created = datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")
        self._write((*known, AccessKey(name, digest_of(secret), created, **limits)))
        return secret

    def remove(self, name: str) -> None:
        """Take a key back.

        Raises
        ------
        BadInput
            There is none of this name.
        """
        known = self.read()
        left = tuple(key for key in known if key.name != name)
        if len(left) == len(known):
            names = ", ".join(key.name for key in known) or "none"
            raise BadInput.of("name", name, f"one of the keys: {names}", "loa keys list shows them.")
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


def digest_of(secret: str) -> str:
    """Return what is kept of a key, hexadecimal."""
    return hashlib.sha256(secret.encode("utf-8", "surrogateescape")).hexdigest()


def _checked(entry: dict[str, object]) -> AccessKey:
    """Return one entry; raise ValueError or TypeError if it is none."""
    key = AccessKey(**{name: entry[name] for name in _FIELDS & set(entry)})  # type: ignore[arg-type]
    if len(bytes.fromhex(key.sha256)) != hashlib.sha256().digest_size or not isinstance(key.name, str):
        raise ValueError(entry)
    for field in _LIMITS:
        limit = getattr(key, field)
        if limit is not None and (not isinstance(limit, int) or limit < _LEAST.get(field, 1)):
            raise ValueError(entry)
    return key
