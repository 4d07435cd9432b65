"""The command line: what is printed where, and with which exit code."""

import csv
import io
import json
import math
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import pytest
import typer
from command_line import loa, printed
from repository import ROOT
from small_table import small_table
from typer.testing import CliRunner

from lineofaction.cli import commands
from lineofaction.cli.verb_parameters import grouped, parameters_of
from lineofaction.client import JobState, LineOfActionClient, OfflineWarning

VERBS = (
    "analyze",
    "ste",
    "root-stress",
    "simulate",
    "report",
    "sensitivity",
    "frontier",
    "optimize",
    "scatter",
    "sweep",
    "plan",
    "serve",
    "submit",
    "fetch",
    "jobs",
    "dismiss",
)


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    file = tmp_path_factory.mktemp("table") / "ste.nc"
    small_table().to_netcdf(file)
    return file


def closed_form(position: float) -> float:
    """Transmission error of the small table at 100 N m, um."""
    stiffness = 3.5e8 - 0.5e8 * math.cos(2.0 * math.pi * position)
    return 1e6 * float(small_table().force[2]) / stiffness


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_an_example(verb):
    result = loa(verb, "--help")
    assert result.exit_code == 0
    assert f"Example: loa {verb}" in result.stdout
    sentence = "".join(result.stdout.split("\n\n")[1].split()).replace("-", "")
    assert sentence in "".join(loa("--help").stdout.split()).replace("-", "")


def test_the_help_names_the_exit_codes():
    text = " ".join(loa("--help").stdout.split())
    assert (
        "1 a mesh, a solve or a job failed; 2 bad input; 3 warnings under --strict; 4 no service answers"
        in text
    )


def test_json_holds_the_contract_and_nothing_else(table):
    answer = printed("ste", table, "--torque", 100, "--at", "0,0.25,0.5")
    contract = {"position", "ste_um", "load_share", "mean_um", "peak_to_peak_um", "harmonics_um"}
    assert contract <= set(answer)
    assert answer["position"] == [0.0, 0.25, 0.5]
    assert answer["ste_um"] == pytest.approx([closed_form(x) for x in (0.0, 0.25, 0.5)], rel=1e-9)
    assert answer["peak_to_peak_um"] == pytest.approx(closed_form(0.0) - closed_form(0.5), rel=1e-6)
    assert np.sum(answer["load_share"], axis=1) == pytest.approx(1.0)


def test_csv_says_the_same_as_json(table):
    answer = printed("ste", table, "--torque", 100)
    rows = list(csv.DictReader(io.StringIO(loa("ste", table, "--torque", 100, "--csv").stdout)))
    assert [float(row["position"]) for row in rows] == answer["position"]
    assert [float(row["ste_um"]) for row in rows] == pytest.approx(answer["ste_um"], rel=1e-8)


def test_a_table_for_people_shows_the_figures(table):
    text = loa("ste", table, "--torque", 100, "--at", "0.5").stdout
    assert text.splitlines()[1].split()[:2] == ["0.50000", f"{closed_form(0.5):.4f}"]


def test_force_and_torque_are_the_same_question(table):
    force = float(small_table().force[2])
    by_torque = printed("ste", table, "--torque", 100)
    assert printed("ste", table, "--force", repr(force)) == by_torque


def test_without_a_load_the_curve_is_that_of_the_highest(table):
    highest = small_table().force[-1]
    assert highest > small_table().force[2]
    assert printed("ste", table) == printed("ste", table, "--force", repr(float(highest)))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--torque", "100", "--force", "2660"], "--torque = "),
        (["--torque", "nan"], "--torque = nan: must be a finite number"),
        (["--torque", "-5"], "torque_n_m = -5.0: must be above 0"),
        (["--torque", "1000"], "torque_n_m = 1000.0: must be at most 200 N m"),
        (["--torque", "100", "--at", "0,x"], "--at = '0,x'"),
        (["--torque", "100", "--at", "nan"], "--at = 'nan'"),
        (
            ["--torque", "100", "--misalignment-um", "30"],
            "misalignment_um = 30.0: must be 0. The table has no such axis",
        ),
    ],
)
def test_a_question_that_makes_no_sense_is_one_line(table, arguments, said):
    result = loa("ste", table, *arguments, "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"error: {said}")
    assert len(result.stderr.splitlines()) == 1


def test_a_file_that_is_not_there_or_no_table_is_said(tmp_path):
    missing = loa("ste", tmp_path / "none.nc", "--torque", 1)
    assert missing.exit_code == 2 and "none.nc" in missing.stderr
    (tmp_path / "text.nc").write_text("no netCDF")
    wrong = loa("ste", tmp_path / "text.nc", "--torque", 1)
    assert wrong.exit_code == 1 and wrong.stderr.startswith("error: ") and "Traceback" not in wrong.stderr


def test_an_output_that_cannot_be_written_is_said_before_the_work(tmp_path):
    result = loa("analyze", ROOT / "examples/palermo_spur_20_20.toml", "-o", tmp_path / "no" / "ste.nc")
    assert result.exit_code == 2
    assert "output = " in result.stderr


@pytest.mark.parametrize("verb", ["analyze", "simulate"])
def test_an_output_whose_name_promises_a_picture_is_refused(tmp_path, verb):
    given = ROOT / "examples" / ("palermo_scene.toml" if verb == "simulate" else "palermo_spur_20_20.toml")
    result = loa(verb, given, "-o", tmp_path / "x.png")
    assert result.exit_code == 2
    assert "a file ending in .nc" in result.stderr
    assert "loa report" in result.stderr


def test_no_service_is_exit_code_4(tmp_path):
    result = loa("fetch", "ab" * 32, "-o", tmp_path / "x.nc", "--service", "http://127.0.0.1:9")
    assert result.exit_code == 4
    assert "loa serve" in result.stderr


CASE, SCENE = "palermo_spur_20_20.toml", "palermo_scene.toml"


@pytest.mark.parametrize(
    ("verb", "file", "said"),
    [
        ("simulate", CASE, r"a scene \(with \[\[shafts\]\]\)\. It holds a case .*: loa analyze"),
        ("analyze", SCENE, r"a case \(with \[pair\]\)\. It holds a scene .*: loa simulate"),
    ],
)
def test_a_case_given_as_a_scene_is_one_fault(tmp_path, verb, file, said):
    result = loa(verb, ROOT / "examples" / file, "-o", tmp_path / "x.nc")
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert re.search(rf"^error: file = '.*{file}': must be {said}", line)


def test_a_scene_with_nothing_in_it_is_told_what_it_lacks(tmp_path):
    (tmp_path / "scene.toml").write_text("[run]\nduration_s = 1.0\n")
    result = loa("simulate", tmp_path / "scene.toml", "-o", tmp_path / "x.nc")
    assert "error: shafts = nothing: must be given. Shafts: a table [[shafts]] for each." in result.stderr
    assert ". ." not in result.stderr


def test_a_case_given_as_a_table_is_told_how_to_make_one():
    result = loa("ste", ROOT / "examples" / CASE, "--torque", "100")
    assert result.exit_code == 2
    assert f"Make one with: loa analyze {ROOT / 'examples' / CASE} -o ste.nc" in result.stderr


def test_a_number_where_a_list_is_due_is_told_the_bound_of_each(tmp_path):
    text = (ROOT / "examples" / CASE).read_text()
    (tmp_path / "case.toml").write_text(re.sub(r"torque_n_m = .*", "torque_n_m = 100", text))
    result = loa("analyze", tmp_path / "case.toml", "-o", tmp_path / "x.nc")
    assert "load.torque_n_m = 100: must be a list in brackets, each from 1e-09" in result.stderr


def test_a_job_submitted_names_the_command_that_fetches_its_result(monkeypatch):
    job = JobState("1-2", "analyze", "accepted", "", "", 0, 0)
    monkeypatch.setattr(LineOfActionClient, "submit", lambda *_: job)
    address = "http://127.0.0.1:9"
    plain = loa("submit", ROOT / "examples" / CASE, "--service", address)
    assert plain.stdout.endswith(f"loa fetch 1-2 --service {address} -o FILE\n")
    machine = loa("submit", ROOT / "examples" / CASE, "--service", address, "--json")
    known = {"job": "1-2", "process": "analyze", "status": "accepted", "warnings": []}
    assert json.loads(machine.stdout) == known


def test_a_setting_out_of_bounds_names_bound_and_variable():
    result = loa("serve", "--port", "99999")
    assert result.exit_code == 2
    assert result.stderr == (
        "error: port = 99999: must be less than or equal to 65535. It is set by LOA_PORT, or by its option.\n"
    )


def test_what_the_client_warns_of_is_one_line_for_people(monkeypatch, capsys):
    def verb():
        warnings.warn("the table comes from the cache", OfflineWarning, stacklevel=1)
        warnings.warn("of a library", UserWarning, stacklevel=1)

    monkeypatch.setattr(commands, "app", verb)
    monkeypatch.setattr(commands, "keep_freed_memory", lambda **_: None)  # of the process of the tests
    with warnings.catch_warnings(record=True) as others:
        warnings.simplefilter("always")
        commands.main()
    assert capsys.readouterr().err == "note: the table comes from the cache\n"
    assert [str(other.message) for other in others] == ["of a library"]


@pytest.mark.parametrize(("verb", "settings"), [("analyze", [{"to_the_end": True}]), ("serve", [])])
def test_a_process_of_one_verb_keeps_freed_memory_and_a_server_does_not(verb, settings, monkeypatch):
    calls: list[dict[str, bool]] = []
    monkeypatch.setattr("sys.argv", ["loa", verb])
    monkeypatch.setattr(commands, "app", lambda: None)
    monkeypatch.setattr(commands, "keep_freed_memory", lambda **setting: calls.append(setting))
    with warnings.catch_warnings():
        monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)  # which `main` replaces
        commands.main()
    assert calls == settings


def test_a_defect_is_a_number_and_a_log(tmp_path, monkeypatch, table):
    def explode(*_, **__):
        raise RuntimeError("the text of a defect")

    monkeypatch.setattr("lineofaction.cli.ste.curve_json", explode)
    result = loa("ste", table, "--torque", 1)
    assert result.exit_code == 5
    assert "the text of a defect" not in result.stderr
    (log,) = (tmp_path / "cache" / "lineofaction" / "log").iterdir()
    assert log.name in result.stderr and "the text of a defect" in log.read_text()


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "example.org"])
def test_the_service_refuses_an_address_that_others_reach(host, monkeypatch):
    def open_nothing(_settings):
        raise AssertionError("a socket would have been opened")

    monkeypatch.setattr(
        "lineofaction.cli.serve._listener", open_nothing
    )  # whatever breaks, this test never listens
    result = loa("serve", "--host", host)
    assert result.exit_code == 2
    assert f"host = '{host}': must be a loopback address" in result.stderr


# ``loa plan``.


AUTOMOTIVE = Path(__file__).parents[3] / "examples" / "sensitivity_automotive.toml"


def plan(*arguments: str) -> str:
    done = loa("plan", AUTOMOTIVE, *arguments)
    assert done.exit_code == 0, done.output
    return done.stdout


def test_json_holds_cost_error_and_effects():
    found = json.loads(plan("--json"))
    assert found["choice"]["level"] == "standard"
    assert found["prediction"]["cpu_seconds"] > 0.0
    assert [entry["level"] for entry in found["levels"]] == ["draft", "standard", "fine"]
    assert {entry["name"] for entry in found["effect_ledger"]} > {"corner_contact", "misalignment"}


# Options that belong together: one dataclass in the verb, one option each on the command line.


@dataclass(frozen=True)
class Size:
    length: Annotated[float, typer.Option(help="Length in mm.")]
    width: Annotated[float, typer.Option(min=1.0, help="Width in mm.")] = 2.0


def drawn(*arguments: str) -> str:
    app = typer.Typer()

    @app.command()
    @grouped
    def draw(*, name: str, size: Size, bold: bool = False) -> None:
        typer.echo(f"{name} {size.length} {size.width} {bold}")

    return CliRunner().invoke(app, arguments).output


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("a", "--length", "3", "--width", "4", "--bold"), "a 3.0 4.0 True\n"),
        (("a", "--length", "3"), "a 3.0 2.0 False\n"),
    ],
)
def test_the_verb_is_called_with_the_group(arguments, said):
    assert drawn(*arguments) == said


@pytest.mark.parametrize(
    ("arguments", "named"),
    [(("a",), "--length"), (("a", "--length", "3", "--width", "0"), "--width")],
)
def test_an_option_of_a_group_has_its_own_faults(arguments, named):
    assert named in drawn(*arguments)
    assert "Error" in drawn(*arguments)


def test_options_stand_where_their_group_stood():
    @grouped
    def verb(*, name: str, size: Size, bold: bool = False) -> None: ...

    assert [part.name for part in parameters_of(verb)] == ["name", "length", "width", "bold"]
