"""Every module imports, and the library computes, where the modules that POSIX alone has are missing."""

import subprocess
import sys

import pytest
from repository import ROOT

BLOCKED = f"""
import importlib, pkgutil, sys, types
sys.path.insert(0, {str(ROOT)!r})
PACKAGES = (
    "host", "bounds", "model_studies", "fe_contact", "dynamics", "lineofaction", "service", "verification",
)
RUN_BY_OTHERS = ("__main__",)

def import_all(but=()):
    for package in map(importlib.import_module, PACKAGES):
        for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            if not found.name.endswith((*RUN_BY_OTHERS, *but)):
                yield importlib.import_module(found.name).__name__

def forget_ours():
    for name in [name for name in sys.modules if name.partition(".")[0] in PACKAGES]:
        del sys.modules[name]

def block():
    sys.modules.update(dict.fromkeys(("resource", "fcntl", "termios", "pwd", "grp")))
    usage = types.SimpleNamespace(memory_info=lambda: types.SimpleNamespace(peak_wset=2**20))
    sys.modules["psutil"] = types.SimpleNamespace(Process=lambda: usage)
"""


def _run(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", BLOCKED + code], capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.law
def test_every_module_imports_without_the_modules_of_posix():
    """What others import of them is loaded before: asyncio needs fcntl on POSIX, and not on Windows."""
    code = """
before = set(import_all())
forget_ours()
block()
print(*before - set(import_all(but=("host.posix",))))
"""
    assert _run(code).split() == ["host.posix"]


@pytest.mark.nightly
def test_without_them_a_pair_is_computed_to_the_same_last_bit():
    code = """
import numpy as np
from fe_contact import Gear, GearPair, analyze
def computed():
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    return analyze(pair, torques=[100.0], model="plane_strain", level="draft", cache=None)
"""
    ends = "table = computed(); print(table.static_transmission_error.tobytes().hex()); "
    receipt = "print(table.metadata.receipt['peak_memory_bytes'])"
    here, blocked = _run(code + ends), _run("block()" + code + ends + receipt)
    assert blocked.split() == [*here.split(), str(2**20)]
