"""Arguments that tasks share, pickled once."""

from __future__ import annotations

import hashlib
import pickle
import shutil
import tempfile
import threading
import weakref
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

KEPT = 2
"""Shared things that a thread of a worker keeps: what it prepared of one serves all its tasks."""
_local = threading.local()


@dataclass(frozen=True)
class Packed:
    """Something pickled, with its digest; in a file if that is given."""

    content: bytes
    digest: str
    file: Path | None = None

    @classmethod
    def of(cls, shared: object) -> Packed:
        """Pickle it."""
        content = pickle.dumps(shared, protocol=pickle.HIGHEST_PROTOCOL)
        return cls(content, hashlib.sha256(content).hexdigest())

    def in_file(self, folder: Path) -> Packed:
        """Put it into a file of the folder."""
        file = folder / self.digest
        file.write_bytes(self.content)
        return Packed(b"", self.digest, file)

    def unpacked(self) -> Any:
        """Return it; the same object for all tasks of a thread, so that what it keeps is kept."""
        known: dict[str, Any] = _local.__dict__.setdefault("known", {})
        if self.digest not in known:
            while len(known) >= KEPT:
                known.pop(next(iter(known)))
            content = self.content if self.file is None else self.file.read_bytes()
            known[self.digest] = pickle.loads(content)
        return known[self.digest]


class PassedFiles:
    """A folder for what goes to other processes of this machine; it ends with the last reference to it."""

    @cached_property
    def path(self) -> Path:
        """The folder, made when first requested."""
        path = Path(tempfile.mkdtemp(prefix="lineofaction-"))
        weakref.finalize(self, shutil.rmtree, path, ignore_errors=True)
        return path
