"""Published figures of gears of FZG (folder LOA_FZG_REFERENCE)."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

SETTING = "LOA_FZG_REFERENCE"

FOLDER = Path(os.environ.get(SETTING) or "/nonexistent")
needs_fzg_reference = pytest.mark.skipif(
    not (FOLDER / "stplus_geometry.csv").is_file(), reason=f"{SETTING} names no folder of FZG figures"
)

_PROFILE = re.compile(r"Zahn-Nr\.: (\d+) (links|rechts) / (\d+)  Werte  z=")


def profile_traces() -> dict[str, np.ndarray]:
    """Return material removed (k,) in m along the profiles of the curve files, evenly in roll length."""
    traces = {}
    for path in sorted(FOLDER.glob("*.mka")):
        lines = path.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            if match := _PROFILE.match(line):
                tooth, flank, count = match.groups()
                text = " ".join(lines[number + 1 : number + 1 + int(count) // 12])
                values = np.array(text.split(), dtype=float)
                measured = values[values > -1e6]
                sign = {"links": 1.0, "rechts": -1.0}[flank]
                traces[f"{path.stem[:11]} {tooth} {flank}"] = 1e-6 * sign * measured
    return traces
