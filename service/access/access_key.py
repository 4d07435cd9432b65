"""The record of an access key."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields
from typing import Any

from service.access.holder import LEAST, Holder, Scope
from service.access.lifetime import read
from service.project import COMMON, PROJECT


@dataclass(frozen=True, kw_only=True)
class AccessKey(Holder):
    """The record of a key, which names its holder.

    Attributes
    ----------
    sha256 : str
        Of the key, hexadecimal.
    created : str
        RFC 3339, UTC.
    """

    sha256: str
    created: str


def record_of(entry: dict[str, Any]) -> AccessKey:
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
        read(key.expires)
    for name, limit in key.limits.items():
        if limit is not None and (not isinstance(limit, int) or limit < LEAST.get(name, 1)):
            raise ValueError(entry)
    return key
