"""What is implausible comes before the numbers, into JSON and files, and decides the exit code if asked."""

import json

import h5netcdf
import pytest
from click import Context
from command_line import loa
from spur_case import spur_case
from typer.main import get_command

from fe_contact import SteDatabase
from lineofaction.cli.commands import app
from lineofaction.gearbox.problems import EXIT_BAD_INPUT, EXIT_WARNINGS

NOT_COMPUTING = {
    "new",
    "cache",
    "hardcases",
    "validate",
    "serve",
    "keys",
    "database",
    "store",
    "jobs",
    "dismiss",
    "doctor",
}
LOA = get_command(app)  # loads its verbs when asked: the application itself lists none
VERBS = LOA.list_commands(Context(LOA))
CASE = spur_case("{relief}", torques=[100.0], model="plane_strain", receipt="minimal", positions=8)
MESSAGE = "pair.pinion.tip_relief_um = 0.02 µm: "


@pytest.fixture
def case(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(CASE.format(relief="tip_relief_um = 0.02\ntip_relief_length_mm = 1.5"))
    return file


def test_a_plan_says_it_first_and_keeps_its_exit_code(case):
    done = loa("plan", case)
    assert done.exit_code == 0
    assert done.stdout.startswith(f"warning (relief_amount): {MESSAGE}")


def test_strict_ends_with_its_own_code(case):
    done = loa("plan", case, "--strict")
    assert done.exit_code == EXIT_WARNINGS == 3
    assert done.stderr == "error: 1 warning under --strict\n"
    assert "nothing is computed yet" in done.stdout


def test_strict_without_warnings_is_done(case):
    case.write_text(CASE.format(relief=""))
    done = loa("plan", case, "--strict", "--json")
    assert done.exit_code == 0
    assert json.loads(done.stdout)["warnings"] == []


def test_bad_input_stays_bad_input_under_strict(case):
    case.write_text(CASE.format(relief="teth = 3"))
    assert loa("plan", case, "--strict").exit_code == EXIT_BAD_INPUT


def test_table_report_and_json_carry_it(case, tmp_path):
    """The file says it to whoever reads it: curve, report, Python."""
    table, page = tmp_path / "ste.nc", tmp_path / "page.html"
    done = loa("analyze", case, "-o", table, "--json")
    (warning,) = json.loads(done.stdout)["warnings"]
    assert (warning["check"], warning["value"], warning["unit"]) == ("relief_amount", 0.02, "um")
    with h5netcdf.File(table, "r") as content:
        assert json.loads(content.attrs["warnings"]) == [warning]
    assert SteDatabase.from_netcdf(table).warnings == (warning["message"],)
    curve = loa("ste", table, "--torque", 100, "--csv", "--strict")
    assert curve.exit_code == EXIT_WARNINGS
    assert curve.stdout.startswith("position") and MESSAGE in curve.stderr
    assert loa("report", table, "-o", page, "--strict").exit_code == EXIT_WARNINGS
    text = page.read_text(encoding="utf-8")
    assert text.index(f"Warning: {MESSAGE}") < text.index('class="headline"')


@pytest.mark.parametrize("name", VERBS)
def test_every_verb_that_computes_can_be_strict(name):
    verb = LOA.get_command(Context(LOA), name)
    assert ("strict" in [option.name for option in verb.params]) == (name not in NOT_COMPUTING)
