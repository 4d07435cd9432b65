"""Cache of answers that depend on stored results and on this program only."""

from __future__ import annotations

import contextlib
import hashlib
import os
import uuid
from pathlib import Path

import structlog

from service.folder_size import evict
from service.store.files import PARTIAL

logger = structlog.get_logger(__name__)

MAX_BYTES = 200_000_000


class KeptAnswers:
    """Bodies of answers in a folder, by tag; the longest unused go first.

    Parameters
    ----------
    folder : Path
        Made with the first answer. Several processes may use it at once.
    max_bytes : int
        Largest size of the folder in bytes.
    """

    def __init__(self, folder: Path, max_bytes: int = MAX_BYTES) -> None:
        self._folder, self._max_bytes = folder, max_bytes

    def find(self, tag: str) -> bytes | None:
        """Return the body of a tag, None if the folder has none."""
        path = self._path(tag)
        try:
            body = path.read_bytes()
            os.utime(path)
        except OSError:
            return None
        return body

    def keep(self, tag: str, body: bytes) -> None:
        """Store a body under a tag; a failure is logged only, since the answer can be computed again."""
        path = self._path(tag)
        draft = path.with_name(f"{path.name}.{uuid.uuid4().hex[:8]}{PARTIAL}")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            draft.write_bytes(body)
            draft.replace(path)
            evict(self._folder, self._max_bytes)
        except OSError as error:
            with contextlib.suppress(OSError):
                draft.unlink()
            logger.warning("answer not kept", error=str(error))

    def _path(self, tag: str) -> Path:
        return self._folder / f"{hashlib.sha256(tag.encode()).hexdigest()}.json"
