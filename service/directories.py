"""Where things are kept on a machine (XDG base directory specification)."""

from __future__ import annotations

import os
from pathlib import Path


def data_home() -> Path:
    """Return the directory for results and jobs."""
    return _base("XDG_DATA_HOME", ".local/share") / "lineofaction"


def cache_home() -> Path:
    """Return the directory for what can be computed or fetched again."""
    return _base("XDG_CACHE_HOME", ".cache") / "lineofaction"


def absolute(path: Path) -> Path:
    """Return a path that means the same in processes that work in other folders; ~ is the user's home."""
    return path.expanduser().absolute()


def _base(variable: str, default: str) -> Path:
    """Return a base directory; the specification has relative ones ignored."""
    given = Path(os.environ.get(variable, ""))
    return given if given.is_absolute() else Path.home() / default
