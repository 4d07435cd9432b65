"""A unit from its REXS file, or a scene, to its report: every verb takes the folder, none a file in it."""

from pathlib import Path
from typing import Any

import pytest
from command_line import loa
from housing_solid import housed_scene, write_block
from printed_pages import Printed
from spur_case import spur_case

from lineofaction.gearbox.project import status_of
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.report.drawing.printing import browser

UNIT = Path(__file__).parents[2] / "examples" / "two_stage" / "two_stage.rexs"
RESTS_ON = ("examples",)
SPEEDS = ("--speed-rpm", "500:6000:2750")
VERBS = {
    "status": (),
    "plan": (),
    "geometry": (),
    "analyze": (),
    "ste": ("--torque", "120"),
    "flank": (),
    "sweep": ("--over", "misalignment=0:10:10"),
    "deflect": (),
    "modes": (),
    "response": SPEEDS,
    "simulate": (),
    "listen": (),
    "report": ("--still",),
}


@pytest.mark.nightly
def test_every_verb_takes_the_folder_that_open_made(tmp_path):
    unit = tmp_path / "unit"
    assert loa("open", UNIT, "-o", unit).exit_code == 0
    for verb, options in VERBS.items():
        done = loa(verb, unit, *options)
        assert done.exit_code == 0, (verb, done.output)
    fresh = {one.verb for one in status_of(unit) if one.state == "fresh"}
    assert fresh == set(VERBS) - {"status", "plan", "geometry", "ste", "report"}
    assert {page.stem for page in unit.glob("*.html")} == {"report"}


# A scene of one pair, to which a housing is added: also what hears it and what searches it.

FEW = ("--speed-rpm", "600:1200:600")
OF_HOUSED = {
    "status": (),
    "plan": (),
    "analyze": (),
    "ste": ("--torque", "100"),
    "deflect": (),
    "modes": (),
    "response": FEW,
    "simulate": (),
    "vibration": FEW,
    "noise": (*FEW, "--orders", "2", "--no-boundary-elements", "--no-band"),
    "sensitivity": ("--misalignment-um", "0,10"),
    "optimize": (),
    "report": ("--still",),
}
SEARCH = """
[search]
trials = 0
sample = 2
positions = 8
exploration = 8
[variables.pinion]
tip_relief_um = [0.0, 20.0]
tip_relief_length_mm = [0.5, 2.0]
[heard]
speed_rpm = [600, 1200]
orders = 2
tolerances = {samples = 2}
"""


def gearbox(folder: Path) -> None:
    """Write a scene of one spur pair without a housing, its case and the file of a search."""
    folder.mkdir()
    scene: dict[str, Any] = {name: own for name, own in housed_scene(folder).items() if name != "housings"}
    (folder / "mesh.nc").unlink()
    del scene["meshes"][0]["database_file"]
    scene["meshes"][0]["case_file"] = "case.toml"
    (folder / "scene.toml").write_text(toml_text(scene))
    (folder / "case.toml").write_text(spur_case(torques=[100.0], positions=8))
    (folder / "search.toml").write_text(SEARCH)


HEADS = {
    "analyze": "Static transmission error",
    "deflect": "Bearings",
    "modes": "Modes",
    "response": "Forced response",
    "simulate": "Dynamic transmission error",
    "vibration": "Vibration of the housing",
    "noise": "Sound power",
    "sensitivity": "Sensitivity",
    "optimize": "What is heard",
}
"""Heading of a result in the report of the folder, by its verb."""


@pytest.fixture(scope="module")
def housed(tmp_path_factory):
    """A folder with a housing, on which every verb has worked."""
    unit = tmp_path_factory.mktemp("housed") / "unit"
    gearbox(unit)
    block = write_block(unit.parent / "block.step")
    housing = {"housing": (block, "--material", "gray_cast_iron")}
    for verb, options in (housing | OF_HOUSED).items():
        done = loa(verb, unit, *options)
        assert done.exit_code == 0, (verb, done.output)
    return unit


@pytest.mark.nightly
def test_every_verb_takes_the_folder_to_which_a_housing_is_added(housed):
    unit = housed
    fresh = {one.verb for one in status_of(unit) if one.state == "fresh"}
    assert fresh == set(OF_HOUSED) - {"status", "plan", "ste", "report"}
    assert (unit / "report.html").is_file()


@pytest.mark.nightly
@pytest.mark.skipif(browser() is None, reason="no browser on this machine that prints")
def test_nine_results_are_printed_on_twelve_pages_each_with_its_head(housed):
    results = {one.verb for one in status_of(housed) if one.state == "fresh"}
    assert results == HEADS.keys() and len(results) == 9
    done = loa("report", housed, "-o", housed.parent / "report.pdf")
    assert done.exit_code == 0, done.output
    printed = Printed((housed.parent / "report.pdf").read_bytes())
    assert len(printed.pages) <= 12
    headings = [printed.words(heading) for heading in printed.document.all("H2")]
    assert {verb: headings.count(head) for verb, head in HEADS.items()} == dict.fromkeys(HEADS, 1)
