"""A study is its folder, its presentation and a row: verb, process, client's method and page follow."""

import json
import shutil
import subprocess
import sys

import pytest
import structure
from repository import ROOT

ROW = """
    made_up = StudyOf(
        _case(lambda: computations.MADE_UP),
        "Made up",
        "Make it up",
        "Make up a number for a case.",
        "case.toml -o made_up.nc",
        group="trust",
        kind="made_up",
        stages=(("number", 1.0),),
    )
"""
INPUTS = '''"""Inputs and figures of a study that is made up."""

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures
from lineofaction.gearbox.schemas.model import BoundaryModel


class Inputs(BoundaryModel):
    """What is varied."""

    factor: float = Field(2.0, description="Factor of the number")


class MadeUpFigures(Figures):
    """A number."""

    number: float
'''
RUN = '''"""The computation of a study that is made up."""

from lineofaction.gearbox.studies.computation import CaseStudy
from lineofaction.gearbox.studies.made_up import Inputs, MadeUpFigures


class _MadeUpStudy(CaseStudy):
    inputs = Inputs
    answer = MadeUpFigures

    def compute(self, subject, inputs, means):
        return {"number": inputs.factor}


RUN = _MadeUpStudy()
'''
PAGE = '''"""A number that is made up, as people see it."""

from lineofaction.report.presentation import Presentation

PAGE = Presentation(figure=None, page=None, text=lambda number: [f"It is {number}."])
'''
FOUND = """
import json, sys
from fastapi.testclient import TestClient
from typer.testing import CliRunner
import lineofaction as loa
from lineofaction.cli.commands import app
from lineofaction.client import LineOfActionClient, Process
from lineofaction.gearbox.registry import STUDIES
from lineofaction.report.presentation import presentation_of
from service.app import create_app
from service.settings import Settings
with TestClient(create_app(Settings(data_directory=sys.argv[1])), base_url="http://127.0.0.1") as http:
    process = http.get("/v1/processes/made-up").json()
print(json.dumps({
    "verbs": CliRunner().invoke(app, ["--help"]).output,
    "verb": CliRunner().invoke(app, ["made-up", "--help"]).output,
    "process": process,
    "method": isinstance(LineOfActionClient().made_up, Process),
    "function": loa.made_up.study is STUDIES["made-up"] and "made_up" in dir(loa),
    "shown": list(presentation_of(STUDIES["made-up"]).text(4)),
}))
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """Return a tree with a study more."""
    folder = tmp_path_factory.mktemp("tree")
    for name in {house.partition(".")[0] for house in structure.HOUSES} - {"lineofaction"}:
        (folder / name).symlink_to(ROOT / name)
    shutil.copytree(ROOT / "lineofaction", folder / "lineofaction")
    shutil.copy(ROOT / "pyproject.toml", folder)
    package = folder / "lineofaction/gearbox/studies/made_up"
    package.mkdir()
    (package / "__init__.py").write_text(INPUTS, "utf-8")
    (package / "run.py").write_text(RUN, "utf-8")
    (folder / "lineofaction/report/effects/made_up.py").write_text(PAGE, "utf-8")
    registry = folder / "lineofaction/gearbox/registry.py"
    code = registry.read_text("utf-8")
    assert code.count(BEFORE) == 1
    registry.write_text(code.replace(BEFORE, f"{ROW}{BEFORE}"), "utf-8")
    return folder


BEFORE = "\n\nflank = Studies.flank.function\n"
"""Line of the registry after its last row."""


def test_verb_process_method_and_page_follow_from_a_row(tree):
    done = subprocess.run(
        [sys.executable, "-P", "-c", FOUND, str(tree / "data")],
        cwd=tree, capture_output=True, text=True, check=False, timeout=300,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(tree), "HOME": str(tree)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert "made-up" in found["verbs"] and "Make up a number for a case." in found["verb"]
    assert "--factor" in found["verb"] and "Factor of the number" in found["verb"]
    assert found["process"]["id"] == "made-up" and set(found["process"]["inputs"]) == {"case", "factor"}
    card = {one["name"]: one["value"] for one in found["process"]["additionalParameters"]["parameters"]}
    assert card["action"] == ["Make it up"] and card["subjects"] == ["case"]
    assert found["method"] and found["function"] and found["shown"] == ["It is 4."]
