"""A table and a run are the same by loops of the family, of the processor by name, and by numba as it is."""

import os
import subprocess
import sys
from pathlib import Path

import h5py
import llvmlite.binding
import numpy as np
import pytest
from numpy.typing import NDArray
from repository import ROOT

VERBS = {"analyze": "palermo_spur_20_20.toml", "simulate": "palermo_scene.toml"}


def results(folder: Path, settings: dict[str, str]) -> dict[str, NDArray[np.float64]]:
    """Compute table and run in processes with settings of their own; returns their fields by name."""
    folder.mkdir()
    kept = {"NUMBA_CACHE_DIR": str(folder / "loops"), "LINEOFACTION_CACHE": str(folder / "cache")}
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **kept, **settings}
    fields: dict[str, NDArray[np.float64]] = {}
    for verb, example in VERBS.items():
        file = folder / f"{verb}.nc"
        command = [sys.executable, "-m", "lineofaction.cli", verb, str(ROOT / "examples" / example)]
        subprocess.run([*command, "-o", str(file)], env=environment, check=True, stdout=subprocess.DEVNULL)
        fields |= {f"{verb} {name}": values for name, values in numbers(file).items()}
    return fields


def numbers(file: Path) -> dict[str, NDArray[np.float64]]:
    """Return the floating-point fields of a file by name."""
    with h5py.File(file) as content:
        names: list[str] = []
        content.visit(names.append)
        items = {name: content[name] for name in names}
        return {
            name: item[()]
            for name, item in items.items()
            if isinstance(item, h5py.Dataset) and item.dtype.kind == "f"
        }


@pytest.mark.nightly
@pytest.mark.parametrize("loops", ["of the processor", "of numba as it is"])
def test_a_table_and_a_run_are_those_of_other_loops(tmp_path, loops):
    name = {"NUMBA_CPU_NAME": str(llvmlite.binding.get_host_cpu_name())}
    settings = {"of the processor": name, "of numba as it is": {"LOA_PLAIN_LOOPS": "1"}}
    family, other = results(tmp_path / "family", {}), results(tmp_path / "other", settings[loops])
    assert family.keys() == other.keys() and len(family) > 30
    for field, values in family.items():
        np.testing.assert_allclose(other[field], values, rtol=0.0, atol=1e-13 * np.nanmax(np.abs(values)))
