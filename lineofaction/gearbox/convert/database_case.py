"""The case that a database file was made of, without reading its arrays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from model_studies.netcdf import opened


def case_of_file(file: Path) -> dict[str, Any] | None:
    """Return the case with all defaults, None if the file is none that can be read."""
    try:
        with opened(file) as content:
            case = json.loads(content.attrs["case"])
    except (KeyError, TypeError, ValueError):
        return None
    return case if isinstance(case, dict) else None
