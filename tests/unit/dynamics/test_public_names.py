"""What `dynamics` offers by name."""

import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec

import pytest

import dynamics


@pytest.mark.parametrize("name", dynamics.__all__)
def test_every_public_name_is_that_of_the_package_that_holds_it(name):
    home = import_module(f"dynamics.{dynamics._HOME[name]}")
    assert getattr(dynamics, name) is getattr(home, name)
    if hasattr(home, "__path__"):
        assert name in home.__all__
    else:  # a module lists nothing, but has what it offers of nobody else
        assert getattr(home, name).__module__ == home.__name__


def test_the_list_is_whole_and_sorted():
    assert sorted(dynamics._HOME) == sorted(dynamics.__all__) == dir(dynamics)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = dynamics.nothing


def test_a_table_of_names_loads_no_compiler():
    """Nor does any of them shadow a package of the library."""
    code = "import sys, dynamics; assert not {'numba', 'scipy', 'h5netcdf'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
    specs = [find_spec(f"dynamics.{name}") for name in dynamics.__all__]
    assert [spec.name for spec in specs if spec is not None and spec.origin is not None] == []
