"""A service answers before it has loaded the libraries that compute."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module

import pytest

from lineofaction.gearbox.loading import on_demand
from service.routes.warm_up import HEAVY, warm_up
from service.worker.process import default_registry

HEAVY_PACKAGES = {"gmsh", "skfem", "numba", "scipy", "xarray", "h5py", "matplotlib", "plotly"}


def test_the_app_is_made_without_the_libraries_that_compute() -> None:
    code = f"import sys, service.app; print(sorted({HEAVY_PACKAGES!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_everything_that_is_called_by_name_exists() -> None:
    for process in default_registry().values():
        for entry in (process.entry, *_names(process.prepare), *_names(process.name_result)):
            module, _, name = entry.partition(":")
            assert callable(getattr(import_module(module), name)), entry


def _names(function: object) -> tuple[str, ...]:
    """Return the name that a function made by `on_demand` will call."""
    cells = getattr(function, "__closure__", None) or ()
    return tuple(cell.cell_contents for cell in cells if ":" in str(cell.cell_contents))


def test_what_is_called_by_name_gets_its_arguments() -> None:
    assert on_demand("math:gcd")(12, 18) == 6
    with pytest.raises(AttributeError):
        on_demand("math:nothing")()


def test_the_rest_is_loaded_behind() -> None:
    thread = warm_up()
    thread.join()
    assert set(HEAVY) <= set(sys.modules)
