"""The directory in which results are kept from run to run."""

from __future__ import annotations

import os
import sys
from pathlib import Path

ENVIRONMENT = "LINEOFACTION_CACHE"
OFF = ("", "0", "off", "none")


def default_cache_directory() -> Path | None:
    """Return where results are kept.

    ``$LINEOFACTION_CACHE`` if set ("off": nowhere, None), else ``lineofaction`` in ``$XDG_CACHE_HOME``, else
    in the platform's directory of caches.
    """
    setting = os.environ.get(ENVIRONMENT)
    if setting is not None:
        return None if setting.strip().lower() in OFF else Path(setting).expanduser().absolute()
    stated = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (stated if stated.is_absolute() else _of_platform()) / "lineofaction"


def _of_platform() -> Path:
    """Return the directory of caches; the specification of XDG has relative ones ignored."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path.home() / ".cache"
