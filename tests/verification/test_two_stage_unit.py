"""A gearbox from its REXS file to its run-up, by the verbs: six CPU minutes."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "examples" / "two_stage" / "unit.py"


@pytest.mark.nightly
def test_the_stage_of_the_larger_ripple_gets_quieter_in_the_run_up(tmp_path: Path) -> None:
    command = [sys.executable, SCRIPT, "-o", tmp_path, "--quick"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = {
        row[0]: (float(row[1]), float(row[2])) for row in re.findall(r"(.+?) +([\d.]+) +([\d.]+)\n", printed)
    }
    assert "optimized: second stage" in printed
    before, after = rows["second stage, peak-to-peak STE, um"]
    assert after < 0.9 * before
    for order, share in ((1, 0.9), (2, 0.5)):
        before, after = rows[f"second stage, order {order}, N"]
        assert after < share * before
    before, after = rows["first stage, peak-to-peak STE, um"]
    assert after == pytest.approx(before, rel=0.02)
    assert (tmp_path / "run_up_after.html").is_file()
