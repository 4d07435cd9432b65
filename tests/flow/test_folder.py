"""A unit from its REXS file, or a scene, to its report: every verb takes the folder, none a file in it."""

from pathlib import Path
from typing import Any

import pytest
from command_line import loa
from housing_solid import housed_scene, write_block
from spur_case import spur_case

from lineofaction.gearbox.project import status_of
from lineofaction.gearbox.schemas.toml import toml_text

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


@pytest.mark.nightly
def test_every_verb_takes_the_folder_to_which_a_housing_is_added(tmp_path):
    unit = tmp_path / "unit"
    gearbox(unit)
    block = write_block(tmp_path / "block.step")
    housing = {"housing": (block, "--material", "gray_cast_iron")}
    for verb, options in (housing | OF_HOUSED).items():
        done = loa(verb, unit, *options)
        assert done.exit_code == 0, (verb, done.output)
    fresh = {one.verb for one in status_of(unit) if one.state == "fresh"}
    assert fresh == set(OF_HOUSED) - {"status", "plan", "ste", "report"}
    assert (unit / "report.html").is_file()
