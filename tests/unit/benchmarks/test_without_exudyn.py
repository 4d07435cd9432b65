"""Without Exudyn the scene that is rebuilt in it says what to install."""

import sys

import pytest
from geared_scenes import gear_pair_scene

from benchmarks.exudyn_scene import run_in_exudyn
from dynamics.errors import InputError
from dynamics.loads import TimeLaw


def test_the_error_names_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "exudyn", None)
    with pytest.raises(InputError, match=r"exudyn = None: must be installed.*pip install exudyn"):
        run_in_exudyn(gear_pair_scene(speed=TimeLaw.constant(90.0)))
