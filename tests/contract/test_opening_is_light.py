"""Opening a gear unit does not load what computes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
COMPUTING = ("numba", "gmsh", "skfem", "scipy.optimize", "scipy.interpolate", "xarray")
UNIT = "examples/two_stage_gearbox.rexs"


@pytest.mark.parametrize("name", COMPUTING)
def test_a_unit_without_catalog_bearings_is_opened_without(name: str, loaded: set[str]) -> None:
    assert name not in loaded


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Return the names of the modules that ``loa open`` has loaded when it ends."""
    code = f"""
import sys
from pathlib import Path
from service.cli.open import run_open
run_open(Path({UNIT!r}), Path({str(tmp_path_factory.mktemp("unit"))!r}), as_json=True)
print(*sys.modules, file=sys.stderr)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120, cwd=ROOT
    )
    loaded = set(done.stderr.split())
    assert '"scene": true' in done.stdout and "service.from_rexs.opened" in loaded
    return loaded
