"""The files that the page is made of: its own, and plotly.js from the plotly package."""

from __future__ import annotations

import gzip
import hashlib
import importlib.util
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

_DIRECTORY = Path(__file__).parent / "static"
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
PLOTLY = "plotly.min.js"


@dataclass(frozen=True)
class PageFile:
    """One file in memory.

    Attributes
    ----------
    content : bytes
    media_type : str
    """

    content: bytes
    media_type: str

    @cached_property
    def tag(self) -> str:
        """Name of this version, by its content."""
        return f'"{hashlib.sha256(self.content).hexdigest()[:32]}"'

    @cached_property
    def packed(self) -> bytes:
        """Return the content compressed, the same bytes every time."""
        return gzip.compress(self.content, mtime=0)


@lru_cache(maxsize=64)
def page_file(name: str) -> PageFile | None:
    """Return the file of this name, None if the page has none."""
    path = _plotly() if name == PLOTLY else _own().get(name)
    return None if path is None else PageFile(path.read_bytes(), _TYPES[path.suffix])


@lru_cache(maxsize=1)
def _own() -> dict[str, Path]:
    """Return the files of this package by name: only those can be requested."""
    return {path.name: path for path in _DIRECTORY.iterdir() if path.suffix in _TYPES}


def _plotly() -> Path:
    """Return the script in the plotly package, which need not be imported for it."""
    spec = importlib.util.find_spec("plotly")
    assert spec is not None and spec.origin is not None
    return Path(spec.origin).parent / "package_data" / PLOTLY
