"""The case that a database file was made of, without reading its arrays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py


def case_of_file(file: Path) -> dict[str, Any] | None:
    """Return the case with all defaults, None if the file is none that can be read."""
    try:
        with h5py.File(file) as content:
            case = json.loads(content.attrs["case"])
    except (OSError, KeyError, TypeError, ValueError):
        return None
    return case if isinstance(case, dict) else None
