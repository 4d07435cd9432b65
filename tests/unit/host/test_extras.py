"""Extras: what a base install does without, and what it is told."""

import re
import subprocess
import sys
import tomllib
import warnings

import pytest
from repository import ROOT
from small_table import small_table
from study_rows import ROWS

import lineofaction as loa_names
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
    require.cache_clear()
    with pytest.raises(MissingExtra, match=re.escape(f"skfem is not installed. {ANALYSIS_ADVICE}")):
        require("analysis")
    assert missing_extra(ModuleNotFoundError(name="numba.core")) is not None
    assert missing_extra(ModuleNotFoundError(name="something")) is None


HIDDEN = sorted({name for names in MODULES.values() for name in names} | {"llvmlite", "starlette", "uvloop"})


ABSENT = """
import importlib, sys
from importlib import metadata
sys.modules.update(dict.fromkeys({hidden!r}))  # importing one of them fails now
read = metadata.Distribution.from_name.__func__
def found(cls, name):
    if name.replace("-", "_") in {hidden!r} or name == "scikit-fem":
        raise metadata.PackageNotFoundError(name)
    return read(cls, name)
metadata.Distribution.from_name = classmethod(found)
"""


def in_the_base(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    hidden = ABSENT.format(hidden=HIDDEN)
    command = [sys.executable, "-c", hidden + code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT, timeout=900)


def loa(*arguments: str) -> subprocess.CompletedProcess[str]:
    return in_the_base("from lineofaction.cli import main\nsys.argv[0] = 'loa'\nmain()", *arguments)


@pytest.mark.law
def test_every_module_of_the_libraries_is_imported_and_what_computes_says_what_it_needs(tmp_path):
    small_table().to_netcdf(tmp_path / "table.nc")
    code = """
import pkgutil
import bounds, dynamics, fe_contact, lineofaction, model_studies
COMPILERS = ("dynamics.structure_code", "dynamics.kernels.", "dynamics.integrators.code_choice")
for package in (bounds, model_studies, fe_contact, dynamics):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.startswith(COMPILERS):
            importlib.import_module(module.name)
gear = fe_contact.Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
pair = fe_contact.GearPair(gear, gear, center_distance=80e-3)
rotor = "examples/jeffcott_scene.toml"
table = fe_contact.SteDatabase.from_netcdf(sys.argv[1])
for compute in (
    lambda: fe_contact.analyze(pair, torques=[100.0]),
    lambda: lineofaction.simulate(rotor),
    table.to_xarray,
    table.to_dataframe,
):
    try:
        compute()
    except Exception as error:
        print(error)
"""
    run = in_the_base(code, str(tmp_path / "table.nc"))
    assert (run.returncode, run.stderr) == (0, "")
    needs = ("gmsh", "gmsh", "xarray", "pandas")
    assert run.stdout.splitlines() == [f"{name} is not installed. {ANALYSIS_ADVICE}" for name in needs]


@pytest.mark.law
def test_the_base_reads_and_reports_tables(tmp_path):
    table = small_table()
    table.to_netcdf(tmp_path / "table.nc")
    read = loa("ste", str(tmp_path / "table.nc"), "--torque", str(table.torque[-1]))
    assert (read.returncode, read.stderr) == (0, "")
    assert "peak to peak" in read.stdout
    report = loa("report", str(tmp_path / "table.nc"), "-o", str(tmp_path / "report.html"))
    assert (report.returncode, report.stderr) == (0, "")
    assert "ransmission error" in (tmp_path / "report.html").read_text("utf-8")


REPORTED = """
from pathlib import Path
import lineofaction as loa
import matplotlib.pyplot as plt
from lineofaction.report.document import write_report
for name in sys.argv[1:]:
    loa.read(name).plot()
    plt.close("all")
    write_report(Path(name), Path(name).with_suffix(".html"))
    print(Path(name).name)
"""


@pytest.mark.nightly  # computes a result of each kind
def test_the_base_reads_plots_and_reports_results_of_every_kind(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    files = []
    for row in ROWS:
        inputs, more = row.inputs, {}
        subject = inputs.pop(row.subject)
        with warnings.catch_warnings(action="ignore"):
            if row.study == "listen":
                more["run"] = loa_names.simulate(subject)
                more["run"].to_netcdf(tmp_path / "run.nc")
                files.append(tmp_path / "run.nc")
            result = row.registered.function(subject, inputs, **more)
        files.append(loa_names.write(result, tmp_path / f"{row}.nc"))
    run = in_the_base(REPORTED, *map(str, files))
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.splitlines() == [file.name for file in files]


@pytest.mark.law
def test_the_base_refuses_to_compute_and_to_serve(tmp_path):
    refused = loa("analyze", "examples/palermo_spur_20_20.toml", "-o", str(tmp_path / "ste.nc"))
    assert refused.returncode == 1
    assert re.fullmatch(rf"error: \w+ is not installed\. {re.escape(ANALYSIS_ADVICE)}\n", refused.stderr)
    refused = loa("serve", "--data-directory", str(tmp_path / "data"))
    assert refused.returncode == 1
    assert re.fullmatch(r"error: \w+ is not installed\. .*'lineofaction\[service\]'\n", refused.stderr)
