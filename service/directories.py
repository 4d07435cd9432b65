"""The directories of a machine (XDG base directory specification)."""

from __future__ import annotations

import contextlib
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


def private(directory: Path) -> Path:
    """Return a directory that is its owner's alone (0700), made if it does not exist; for POSIX systems."""
    directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    with contextlib.suppress(PermissionError):  # another's: whoever made it decides
        directory.chmod(0o700)
    return directory


def keep_private() -> None:
    """Let what this process and its children write be their owner's alone: 0600, folders 0700."""
    os.umask(0o077)


def _base(variable: str, default: str) -> Path:
    """Return a base directory; the specification has relative ones ignored."""
    path = Path(os.environ.get(variable, ""))
    return path if path.is_absolute() else Path.home() / default
