"""A unit from its REXS file to its report: every verb takes the folder, none a file in it."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import loa

from lineofaction.gearbox.project import status_of

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
def test_every_verb_takes_the_folder_that_open_made(tmp_path: Path) -> None:
    unit = tmp_path / "unit"
    assert loa("open", UNIT, "-o", unit).exit_code == 0
    for verb, options in VERBS.items():
        done = loa(verb, unit, *options)
        assert done.exit_code == 0, (verb, done.output)
    fresh = {one.verb for one in status_of(unit) if one.state == "fresh"}
    assert fresh == set(VERBS) - {"status", "plan", "geometry", "ste", "report"}
    assert {page.stem for page in unit.glob("*.html")} == {"report", "first_stage", "second_stage"}
