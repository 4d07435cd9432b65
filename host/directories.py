"""The directories of a machine (XDG base directory specification, which has relative ones ignored)."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

ENVIRONMENT = "LINEOFACTION_CACHE"
OFF = ("", "0", "off", "none")


def default_cache_directory() -> Path | None:
    """Return the directory of the cache, None if it is off.

    ``$LINEOFACTION_CACHE`` if set ("off": None), else ``lineofaction`` in ``$XDG_CACHE_HOME``, else
    in the platform's directory of caches.
    """
    setting = os.environ.get(ENVIRONMENT)
    if setting is not None:
        return None if setting.strip().lower() in OFF else Path(setting).expanduser().absolute()
    configured = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (configured if configured.is_absolute() else _of_platform()) / "lineofaction"


def _of_platform() -> Path:
    """Return the directory of caches; the specification of XDG has relative ones ignored."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path.home() / ".cache"


def data_home() -> Path:
    """Return the directory for results and jobs."""
    configured = Path(os.environ.get("XDG_DATA_HOME", ""))
    return (configured if configured.is_absolute() else Path.home() / ".local" / "share") / "lineofaction"


def cache_home() -> Path:
    """Return the directory for files that can be computed or fetched again; a private one without caches."""
    return default_cache_directory() or Path(_process_folder().name)


def absolute(path: Path) -> Path:
    """Return a path that means the same in processes that work in other folders; ~ is the user's home."""
    return path.expanduser().absolute()


@contextlib.contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """Yield a draft of `path`, which gets the rights of a new file and its place; an error leaves nothing."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    os.close(handle)
    draft = Path(name)
    try:
        yield draft
        mask = os.umask(0)
        os.umask(mask)
        draft.chmod(0o666 & ~mask)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def private(directory: Path) -> Path:
    """Return a directory that is its owner's alone (0700), made if it does not exist; for POSIX systems."""
    directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    with contextlib.suppress(PermissionError):  # another's: whoever made it decides
        directory.chmod(0o700)
    return directory


def keep_private() -> None:
    """Make files of this process and its children readable by their owner alone: 0600, folders 0700."""
    os.umask(0o077)


@lru_cache(maxsize=1)
def _process_folder() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="lineofaction-", ignore_cleanup_errors=True)
