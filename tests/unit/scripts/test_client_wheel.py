"""The client as a distribution of its own: it needs three packages, and runs from its own files alone."""

import subprocess
import sys
import tomllib
import zlib
from pathlib import Path

import client_wheel
import httpx2
import pytest
from repository import ROOT

WITHOUT = ("gmsh", "skfem", "numba", "scipy", "xarray", "h5py", "fastapi", "tenacity", "rich", "typer")
USE = """
import sys
sys.modules.update(dict.fromkeys({without!r}))  # importing one of these fails now
sys.path[:0] = [{tree!r}, {packages!r}]
from pathlib import Path
import httpx2
import service
from lineofaction.client import AsyncLineOfActionClient, LineOfActionClient
from lineofaction.gearbox.problems import Unreachable
assert service.__file__.startswith({tree!r})
def away(request):
    raise httpx2.ConnectError("away")
with LineOfActionClient("http://127.0.0.1:9", transport=httpx2.MockTransport(away), attempts=1) as client:
    for call, subject in ((client.analyze, "palermo_spur_20_20"), (client.simulate, "palermo_scene"),
                          (client.plan, "palermo_spur_20_20")):
        try:
            call(Path({examples!r}) / (subject + ".toml"))
        except Unreachable:
            print("away")
try:
    client.analyze._offer.read(Path("x.nc"))
except ModuleNotFoundError as error:
    print(error)
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """The sources of the distribution."""
    folder = tmp_path_factory.mktemp("client")
    client_wheel.collect(folder)
    return folder


def test_it_runs_from_its_own_files(tree):
    packages = str(Path(httpx2.__file__).parents[1])
    code = USE.format(without=WITHOUT, tree=str(tree), packages=packages, examples=str(ROOT / "examples"))
    command = [sys.executable, "-I", "-S", "-c", code]  # no editable install of the project in sight
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tree)
    assert done.stderr == ""
    *away, remedy = done.stdout.splitlines()
    assert away == ["away"] * 3
    assert "pip install lineofaction" in remedy and "job.figures()" in remedy


def test_it_is_small_and_is_of_this_version(tree):
    project = tomllib.loads((tree / "pyproject.toml").read_text("utf-8"))["project"]
    whole = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert project["version"] == whole["version"]
    assert set(project["dependencies"]) < set(whole["dependencies"])
    sources = [file for file in tree.rglob("*") if file.is_file() and file.suffix != ".pyc"]
    download = sum(len(zlib.compress(file.read_bytes())) for file in sources)  # as a wheel packs them
    assert download < 400_000
    assert {"lineofaction/py.typed", "service/py.typed"} <= {
        str(file.relative_to(tree)) for file in tree.rglob("*")
    }
    for heavy in ("fe_contact/contact", "fe_contact/analysis", "dynamics/integrators", "service/routes"):
        assert not (tree / heavy).exists()
