"""Extras: what a base install does without, and what it is told."""

import re
import subprocess
import sys
import tomllib

import pytest
from repository import ROOT
from small_table import small_table

from host.extras import MODULES, MissingExtra, missing_extra, require

EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
IMPORTED_AS = {"scikit-fem": "skfem", "opentelemetry-api": "opentelemetry"}
ANALYSIS_ADVICE = "It comes with the extra analysis: pip install 'lineofaction[analysis]'"


@pytest.mark.parametrize("extra", MODULES)
def test_modules_of_an_extra_are_those_that_it_requires_everywhere(extra):
    everywhere = [line for line in EXTRAS[extra] if ";" not in line and not line.startswith("lineofaction")]
    names = [re.split(r"[^\w-]", line)[0] for line in everywhere]
    assert {IMPORTED_AS.get(name, name.replace("-", "_")) for name in names} == set(MODULES[extra])


def test_a_missing_module_is_named_with_its_extra(monkeypatch):
    require("analysis")
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(MissingExtra, match=re.escape(f"skfem is not installed. {ANALYSIS_ADVICE}")):
        require("analysis")
    assert missing_extra(ModuleNotFoundError(name="numba.core")) is not None
    assert missing_extra(ModuleNotFoundError(name="something")) is None


HIDDEN = sorted({name for names in MODULES.values() for name in names} | {"llvmlite", "starlette", "uvloop"})
PACKAGES = (
    "fe_contact.analysis", "fe_contact.contact", "fe_contact.compliance", "fe_contact.mesh",
    "fe_contact.microgeometry", "dynamics.simulation", "dynamics.linearize",
    "dynamics.forces", "lineofaction.report.document",
)  # fmt: skip
NO_ANALYSIS = f"gmsh is not installed. {ANALYSIS_ADVICE}"


def in_the_base(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    hidden = f"import importlib, sys\nsys.modules.update(dict.fromkeys({HIDDEN!r}))\n"  # importing fails now
    command = [sys.executable, "-c", hidden + code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT, timeout=120)


def loa(*arguments: str) -> subprocess.CompletedProcess[str]:
    return in_the_base("from lineofaction.cli import main\nsys.argv[0] = 'loa'\nmain()", *arguments)


@pytest.mark.law
def test_packages_that_compute_say_what_they_need():
    code = f"""
from fe_contact import Gear, SteDatabase
from lineofaction.client import LineOfActionClient
Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
for name in {PACKAGES}:
    try:
        importlib.import_module(name)
        print(name, "is imported")
    except ImportError as error:
        print(error)
"""
    run = in_the_base(code)
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.splitlines() == [NO_ANALYSIS] * len(PACKAGES)


@pytest.mark.law
def test_the_base_reads_tables(tmp_path):
    table = small_table()
    table.to_netcdf(tmp_path / "table.nc")
    read = loa("ste", str(tmp_path / "table.nc"), "--torque", str(table.torque[-1]))
    assert (read.returncode, read.stderr) == (0, "")
    assert "peak to peak" in read.stdout


@pytest.mark.law
def test_the_base_refuses_to_compute_and_to_serve(tmp_path):
    refused = loa("analyze", "examples/palermo_spur_20_20.toml", "-o", str(tmp_path / "ste.nc"))
    assert (refused.returncode, refused.stderr) == (1, f"error: {NO_ANALYSIS}\n")
    refused = loa("serve", "--data-directory", str(tmp_path / "data"))
    assert refused.returncode == 1
    assert re.fullmatch(r"error: \w+ is not installed\. .*'lineofaction\[service\]'\n", refused.stderr)
