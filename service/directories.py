"""Where things are kept on a machine (XDG base directory specification)."""

from __future__ import annotations

import os
from pathlib import Path


def data_home() -> Path:
    """Return the directory for results and jobs."""
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share") / "lineofaction"


def cache_home() -> Path:
    """Return the directory for what can be computed or fetched again."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "lineofaction"
