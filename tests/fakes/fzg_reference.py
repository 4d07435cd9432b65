"""Published figures of gears of FZG (folder LOA_FZG_REFERENCE)."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import pytest

SETTING = "LOA_FZG_REFERENCE"

_folder = Path(os.environ.get(SETTING) or "/nonexistent")
needs_fzg_reference = pytest.mark.skipif(
    not (_folder / "stplus_geometry.csv").is_file(), reason=f"{SETTING} names no folder of FZG figures"
)

Row = dict[str, str]


def geometry_listing(pair: str, kind: str) -> list[Row]:
    """Return the rows of a pair, its inputs or what is printed of it; none without the folder."""
    path = _folder / "stplus_geometry.csv"
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as lines:
        return [row for row in csv.DictReader(lines) if (row["pair"], row["kind"]) == (pair, kind)]
