"""`scripts/test --quick` leaves out files by what they import."""

import subprocess
from types import ModuleType

import pytest
from quick_tests import imports_long

import dynamics
import fe_contact
from fe_contact.geometry import tooth_profile


@pytest.mark.parametrize(
    ("value", "long"),
    [
        (fe_contact.analyze, True),
        (dynamics.simulate, True),
        (subprocess, True),
        (subprocess.run, True),
        (fe_contact.Gear, False),
        (tooth_profile, False),
        (1.0, False),
    ],
)
def test_a_file_is_as_quick_as_what_it_imports(value, long):
    file = ModuleType("test_something")
    file.imported = value
    assert imports_long(file) == long
