"""The files of the pages: the service's, the player of reports, plotly.js, Swagger UI."""

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
    ".json": "application/json",
}
PLOTLY = "plotly.min.js"
_FROM_PACKAGES = {
    PLOTLY: ("plotly", "package_data"),
    "swagger-ui-bundle.js": ("fastapi_swagger", "resources"),
    "swagger-ui.css": ("fastapi_swagger", "resources"),
    "player.js": ("lineofaction", "report/drawing"),
    "player.css": ("lineofaction", "report/drawing"),
}
"""Package of a file, and its folder in that package."""


@dataclass(frozen=True)
class PageFile:
    """A file in memory."""

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


@lru_cache(maxsize=256)  # more than there are files
def page_file(name: str) -> PageFile | None:
    """Return the file of this name, None if the page has none."""
    path = _packaged().get(name)
    if name in _FROM_PACKAGES:  # found without an import of the package
        package, folder = _FROM_PACKAGES[name]
        spec = importlib.util.find_spec(package)
        assert spec is not None and spec.origin is not None
        path = Path(spec.origin).parent / folder / name
    return None if path is None else PageFile(path.read_bytes(), _TYPES[path.suffix])


@lru_cache(maxsize=1)
def _packaged() -> dict[str, Path]:
    """Return the files of this package by name; no other file can be requested."""
    return {path.name: path for path in _DIRECTORY.iterdir() if path.suffix in _TYPES}
