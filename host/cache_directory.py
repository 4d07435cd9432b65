"""The directory in which results are kept from run to run."""

from __future__ import annotations

import os
import sys
from pathlib import Path

ENVIRONMENT = "LINEOFACTION_CACHE"
OFF = ("", "0", "off", "none")


def default_cache_directory() -> Path | None:
    """Return where results are kept.

    ``$LINEOFACTION_CACHE`` if set ("off": nowhere, None), else the platform's cache directory.
    """
    setting = os.environ.get(ENVIRONMENT)
    if setting is not None:
        return None if setting.strip().lower() in OFF else Path(setting)
    if sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        root = Path.home() / "Library" / "Caches"
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "lineofaction"
