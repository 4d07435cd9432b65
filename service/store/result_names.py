"""Names of the files of results: with the bytes, all that is needed to rebuild the index."""

from __future__ import annotations

import re
import uuid
from dataclasses import dataclass

from lineofaction.gearbox.schemas.result_kinds import SUFFIX
from service.project import COMMON, PROJECT, address_of

_DIGEST_LENGTH = 16
_NAME = re.compile(
    rf"(?P<kind>[a-z_]+)/(?P<folder>[0-9a-f]{{2}})/(?:(?P<project>{PROJECT.pattern})\.)?"
    r"(?P<key>(?P=folder)[0-9a-f]{62})"
    rf"(?:\.(?P<digest>[0-9a-f]{{{_DIGEST_LENGTH}}}))?(?:\.[0-9a-f]{{8}})?\.[a-z]+"
)


@dataclass(frozen=True)
class ResultName:
    """The parts of the name of a result's file.

    Attributes
    ----------
    kind, key : str
        As in the index.
    digest : str
        Beginning of the SHA-256 of its bytes; empty in names that older versions gave.
    project : str
        Whose result it is.
    """

    kind: str
    key: str
    digest: str
    project: str = COMMON

    @classmethod
    def of(cls, file: str) -> ResultName | None:
        """Read the name of a file; None if it is not that of a result."""
        parts = _NAME.fullmatch(file)
        if parts is None:
            return None
        return cls(parts["kind"], parts["key"], parts["digest"] or "", parts["project"] or COMMON)

    def agrees(self, sha256: str) -> bool:
        """Whether a file of this digest can have this name; one of an older version can have any."""
        return sha256.startswith(self.digest)


def new_name(project: str, key: str, kind: str, sha256: str) -> str:
    """Return the name of a new file, which no other has."""
    unique = uuid.uuid4().hex[:8]
    return f"{kind}/{key[:2]}/{address_of(project, key)}.{sha256[:_DIGEST_LENGTH]}.{unique}{SUFFIX}"
