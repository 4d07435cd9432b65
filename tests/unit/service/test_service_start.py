"""Before a service or a verb loads the libraries that compute: what it answers, loads later, and sets."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from threading import Barrier

import pytest

from host import ONE_THREAD
from lineofaction.gearbox.loading import on_demand
from service.routes.warm_up import HEAVY, warm_up
from service.worker.process import default_registry

HEAVY_PACKAGES = {"gmsh", "skfem", "numba", "scipy", "xarray", "h5py", "matplotlib", "plotly"}


def test_the_app_is_made_without_the_libraries_that_compute():
    code = f"import sys, service.app; print(sorted({HEAVY_PACKAGES!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_everything_that_is_called_by_name_exists():
    for process in default_registry().values():
        for entry in (process.entry, *_names(process.prepare), *_names(process.name_result)):
            module, _, name = entry.partition(":")
            assert callable(getattr(import_module(module), name)), entry


def _names(function: object) -> tuple[str, ...]:
    """Return the name that a function made by `on_demand` will call."""
    cells = getattr(function, "__closure__", None) or ()
    return tuple(cell.cell_contents for cell in cells if ":" in str(cell.cell_contents))


def test_what_is_called_by_name_gets_its_arguments():
    assert on_demand("math:gcd")(12, 18) == 6
    with pytest.raises(AttributeError):
        on_demand("math:nothing")()


def test_the_rest_is_loaded_behind():
    thread = warm_up()
    thread.join()
    assert set(HEAVY) <= set(sys.modules)


# One thread.


CALLED = """
import json, os, sys
from lineofaction.cli import commands
commands.app = lambda: print(json.dumps([dict(os.environ), "numpy" in sys.modules]))
commands.main()
"""


@pytest.mark.parametrize("set_by_user", [{}, {"OMP_NUM_THREADS": "3"}], ids=["nothing set", "three threads"])
def test_libraries_find_it_before_they_are_loaded(set_by_user):
    bare = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    done = subprocess.run(
        [sys.executable, "-c", CALLED], env=bare | set_by_user, capture_output=True, text=True, check=True
    )
    environment, loaded = json.loads(done.stdout)
    assert not loaded
    found = {name: environment[name] for name in ONE_THREAD if name in environment}
    assert found == (set_by_user or ONE_THREAD)


# Whole, however many ask at once.


MODULE = """
import sys, time
sys.being_loaded.append(__name__)
time.sleep(0.2)
sys.being_loaded.append(__name__)
def named(): return __name__
"""


def test_modules_are_loaded_one_after_the_other(tmp_path, monkeypatch):
    """By the thread that loads what requests will need, and by two that are asked meanwhile."""
    names = ["loaded_first", "loaded_on_demand", "loaded_beside_it"]
    for name in names:
        (tmp_path / f"{name}.py").write_text(MODULE, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    order: list[str] = []
    monkeypatch.setattr(sys, "being_loaded", order, raising=False)
    together = Barrier(2)

    def ask(name):
        together.wait()
        return str(on_demand(f"{name}:named")())

    thread = warm_up(names[:1])
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(ask, names[1:])) == names[1:]
    thread.join()
    assert sorted(order) == sorted(names * 2)
    assert order[::2] == order[1::2], "another one was begun before this one had ended"
    for name in names:
        del sys.modules[name]
